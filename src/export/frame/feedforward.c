{{header}}
//
// feedforward(v, a, turn, turn_accel, input): input of the right (0) and left (1) wheel.
// Friction kS belongs to the direction that moves: of driving where the robot drives, of turning where it
// turns on the spot.

void feedforward(double v, double a, double turn, double turn_accel, double input[2]);

static double sign(double x) { return (x > 0.0) - (x < 0.0); }

void feedforward(double v, double a, double turn, double turn_accel, double input[2]) {
    const double half_track = 0.5 * {{track_width}};
    const double straight = {{linear_kv}} * v + {{linear_ka}} * a;
    const double around = {{angular_kv}} * turn + {{angular_ka}} * turn_accel;
    const double ks = v != 0.0 ? {{linear_ks}} : {{angular_ks}};
    const double right = v + half_track * turn, left = v - half_track * turn;
    input[0] = straight + around + ks * sign(right);
    input[1] = straight - around + ks * sign(left);
}

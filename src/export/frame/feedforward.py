{{header}}
"""Feed-forward of a two-wheel robot.

Friction kS belongs to the direction that moves: of driving where the robot drives, of turning where it turns
on the spot.
"""

LINEAR = {"kS": {{linear_ks}}, "kV": {{linear_kv}}, "kA": {{linear_ka}}}
ANGULAR = {"kS": {{angular_ks}}, "kV": {{angular_kv}}, "kA": {{angular_ka}}}
TRACK_WIDTH = {{track_width}}  # [m]
WHEEL_RADIUS = {{wheel_radius}}  # [m]
LINEAR_PI = {"kP": {{linear_kp}}, "kI": {{linear_ki}}}
ANGULAR_PI = {"kP": {{angular_kp}}, "kI": {{angular_ki}}}


def sign(x):
    return (x > 0) - (x < 0)


def feedforward(v, a, turn, turn_accel):
    """Input of the right and the left wheel."""
    straight = LINEAR["kV"] * v + LINEAR["kA"] * a
    around = ANGULAR["kV"] * turn + ANGULAR["kA"] * turn_accel
    friction = LINEAR["kS"] if v != 0 else ANGULAR["kS"]
    right, left = v + 0.5 * TRACK_WIDTH * turn, v - 0.5 * TRACK_WIDTH * turn
    return (
        straight + around + friction * sign(right),
        straight - around + friction * sign(left),
    )

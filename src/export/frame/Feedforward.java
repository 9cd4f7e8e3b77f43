{{header}}
import edu.wpi.first.math.controller.DifferentialDriveFeedforward;
import edu.wpi.first.math.controller.PIDController;
import edu.wpi.first.math.controller.SimpleMotorFeedforward;
import edu.wpi.first.math.kinematics.DifferentialDriveKinematics;

/** Gains for WPILib; the units are those of its drivetrain identification where the input is in volts. */
public final class Feedforward {
  public static final double TRACK_WIDTH_M = {{track_width}};
  public static final double WHEEL_RADIUS_M = {{wheel_radius}};

  public static final SimpleMotorFeedforward LINEAR =
      new SimpleMotorFeedforward({{linear_ks}}, {{linear_kv}}, {{linear_ka}});
  public static final SimpleMotorFeedforward ANGULAR =
      new SimpleMotorFeedforward({{angular_ks}}, {{angular_kv}}, {{angular_ka}});
  public static final DifferentialDriveFeedforward DRIVE =
      new DifferentialDriveFeedforward({{linear_kv}}, {{linear_ka}}, {{angular_kv}}, {{angular_ka}}, TRACK_WIDTH_M);
  public static final DifferentialDriveKinematics KINEMATICS =
      new DifferentialDriveKinematics(TRACK_WIDTH_M);

  /** Control of the forward speed [m/s]. */
  public static PIDController forward() {
    return new PIDController({{linear_kp}}, {{linear_ki}}, 0.0);
  }

  /** Control of the turn rate [rad/s]. */
  public static PIDController turning() {
    return new PIDController({{angular_kp}}, {{angular_ki}}, 0.0);
  }

  private Feedforward() {}
}

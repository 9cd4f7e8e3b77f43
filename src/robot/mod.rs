//! The robot itself: state, construction data, kinematics, equations of motion.

//! Sensor noise, standstill and independent channels of a recording.

use super::standstill::standstill;
use super::{MotionNoise, Recording, Sensing};

impl Recording {
    /// Noise, standstill and independent channels of the motion. Computed once; copies of the recording
    /// with another input share it.
    #[must_use]
    pub fn sensing(&self) -> &Sensing {
        self.kept().sensing.get_or_init(|| self.sense())
    }

    fn sense(&self) -> Sensing {
        let (noise, measured) = (self.motion_noise(), self.measured());
        // speeds computed from the angles are not an independent measurement
        let speeds = measured.omega && !(measured.alpha && self.speeds_are_smoothed());
        // a channel without any visible noise still has rounding; nothing is known exactly
        let floor = |sigma: f64, scale: f64| (sigma * sigma).max((1e-6 * scale).powi(2));
        let largest =
            |i: usize| self.omega().iter().map(|w| w[i].abs()).fold(0.0, f64::max).max(1e-3);
        let variance = [
            floor(noise.alpha[0], 1.0),
            floor(noise.alpha[1], 1.0),
            floor(noise.omega[0], largest(0)),
            floor(noise.omega[1], largest(1)),
        ];
        Sensing {
            still: standstill(self, &noise.alpha, &noise.omega),
            variance,
            used: [measured.alpha, measured.alpha, speeds, speeds],
            speed_variance: self.speed_variance(&noise, speeds),
        }
    }

    /// In the middle of the longest piece: for equidistant samples it is nearly constant. Repeated
    /// values of a slow sensor and speeds computed from angles contain no information.
    fn speed_variance(&self, noise: &MotionNoise, speeds: bool) -> f64 {
        let repeated = (self.len() as f64 / self.readings() as f64).sqrt();
        let seen = MotionNoise {
            alpha: noise.alpha.map(|sigma| sigma * repeated),
            omega: noise.omega.map(|sigma| if speeds { sigma * repeated } else { f64::INFINITY }),
        };
        let longest = self.pieces().iter().max_by_key(|piece| piece.len());
        longest.map_or(0.0, |piece| {
            let variance = self.local_speed_variance((piece.start + piece.end) / 2, &seen);
            variance.iter().sum()
        })
    }
}

//! Display of the progress of a task.

use super::stage::Stage;
use super::stopped::LaidLength;
use rodlab_robot::StreamState;
use std::path::Path;

/// Shows the progress of a task.
pub trait Display {
    /// A step begins: its number, from one, of a number of steps.
    fn step(&self, number: usize, of: usize, stage: &Stage);

    /// The state of a motion, five times per second, with the laid part of the rod if the motion
    /// lays one.
    fn motion(&self, state: &StreamState, laid: Option<LaidLength>);

    /// The last reported positions of the joints of an arm, rad or m; called in every cycle of a
    /// motion.
    fn joints(&self, _arm: &str, _joints: &[f64]) {}

    /// A file of the results was written.
    fn wrote(&self, _file: &Path) {}
}

/// The state of a motion as text.
pub fn described(state: &StreamState, laid: Option<LaidLength>) -> String {
    let mut words = format!("{:.1} of {:.1} s", state.time, state.duration);
    match state.pace {
        Some(pace) if pace < 1e-3 => words += ", held",
        Some(pace) if pace < 0.999 => words += &format!(" at {:.0} %", 1e2 * pace),
        _ => {}
    }
    if let Some(LaidLength {
        laid_m: Some(laid),
        path_m,
    }) = laid
    {
        words += &format!(", {:.1} of {:.1} cm laid", 1e2 * laid, 1e2 * path_m);
    }
    let off = state.tracking;
    if off.revolute > 0.0 {
        words += &format!(", joints {:.2}°", off.revolute.to_degrees());
    }
    if off.prismatic > 0.0 {
        words += &format!(", slides {:.2} mm", 1e3 * off.prismatic);
    }
    if off.revolute > 0.0 || off.prismatic > 0.0 {
        words += " off";
    }
    if state.lag >= 0.1 {
        words += &format!(", {:.1} s late", state.lag);
    }
    words
}

/// Shows everything on several displays.
pub struct Displays<'a>(pub Vec<&'a dyn Display>);

impl Display for Displays<'_> {
    fn step(&self, number: usize, of: usize, stage: &Stage) {
        self.0.iter().for_each(|one| one.step(number, of, stage));
    }

    fn motion(&self, state: &StreamState, laid: Option<LaidLength>) {
        self.0.iter().for_each(|one| one.motion(state, laid));
    }

    fn joints(&self, arm: &str, joints: &[f64]) {
        self.0.iter().for_each(|one| one.joints(arm, joints));
    }

    fn wrote(&self, file: &Path) {
        self.0.iter().for_each(|one| one.wrote(file));
    }
}

/// Shows nothing.
pub struct Hidden;

impl Display for Hidden {
    fn step(&self, _: usize, _: usize, _: &Stage) {}

    fn motion(&self, _: &StreamState, _: Option<LaidLength>) {}
}

#[cfg(test)]
mod tests {
    use super::*;
    use rodlab_robot::Tolerance;

    #[test]
    fn a_motion_is_described_by_its_time_length_and_tracking() {
        let mut state = StreamState {
            time: 12.34,
            lag: 0.0,
            duration: 40.0,
            tracking: Tolerance::default(),
            pace: None,
        };
        assert_eq!(described(&state, None), "12.3 of 40.0 s");
        let laid = Some(LaidLength {
            laid_m: Some(0.312),
            path_m: 0.654,
        });
        state.tracking.revolute = 0.01;
        state.lag = 0.42;
        assert_eq!(
            described(&state, laid),
            "12.3 of 40.0 s, 31.2 of 65.4 cm laid, joints 0.57° off, 0.4 s late"
        );
        state.pace = Some(0.5);
        let words = described(&state, None);
        assert!(
            words.starts_with("12.3 of 40.0 s at 50 %, joints"),
            "{words}"
        );
        state.pace = Some(0.0);
        let words = described(&state, None);
        assert!(words.starts_with("12.3 of 40.0 s, held, joints"), "{words}");
        state.tracking.prismatic = 2e-4;
        let words = described(&state, None);
        assert!(
            words.contains("joints 0.57°, slides 0.20 mm off"),
            "{words}"
        );
    }
}

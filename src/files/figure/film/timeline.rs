//! Position of each picture of a film between outputs.

use super::super::motion::MovieCase;
use super::{FilmError, FilmOptions, Pace};

/// Default maximum length of a film, s.
const USUAL: f64 = 10.0;
/// Default minimum number of outputs per second of film.
const OUTPUTS: f64 = 6.0;
/// Default time of a full turn around a static scene, s.
const WHOLE_TURN: f64 = 8.0;
/// Maximum number of pictures of a film.
pub const MOST_PICTURES: usize = 20_000;

/// A position between two outputs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Moment {
    pub from: usize,
    pub to: usize,
    /// Position between them as a fraction from 0 to 1.
    pub blend: f64,
    /// Fraction of the film that has passed, 0 to 1.
    pub part: f64,
    /// Time, s, or the parameter of a path of equilibria.
    pub time: f64,
}

/// The pictures of a film.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Timeline {
    /// Positions of the outputs along the film: their times, or their indices on a path of
    /// equilibria.
    places: Vec<f64>,
    times: Vec<f64>,
    pub pictures: usize,
}

impl Timeline {
    pub fn of(case: &MovieCase, options: &FilmOptions) -> Result<Self, FilmError> {
        let times: Vec<f64> = case.frames.iter().map(|frame| frame.time).collect();
        let count = times.len();
        let is_path = case.branches.is_some();
        let places = if is_path {
            (0..count).map(|number| number as f64).collect()
        } else {
            times.clone()
        };
        let duration = times[count - 1] - times[0];
        let is_motion = !is_path && duration > 0.0;
        let seconds = match options.pace {
            Pace::Duration(seconds) => seconds,
            Pace::Speed(speed) if is_motion => duration / speed,
            Pace::Speed(_) => return Err(FilmError::NoSpeed),
            Pace::Usual if count > 1 => ((count - 1) as f64 / OUTPUTS).clamp(1.0, USUAL),
            Pace::Usual => WHOLE_TURN * (options.turn / std::f64::consts::TAU).abs(),
        };
        let pictures = (seconds * options.pictures_per_second).round().max(1.0);
        if pictures.is_nan() || pictures > MOST_PICTURES as f64 {
            return Err(FilmError::TooLong { pictures });
        }
        Ok(Self {
            places,
            times,
            pictures: pictures as usize,
        })
    }

    /// The position of a picture; a film of a single picture shows the last output.
    pub fn moment(&self, picture: usize) -> Moment {
        let part = match self.pictures {
            1 => 1.0,
            pictures => picture as f64 / (pictures - 1) as f64,
        };
        let last = self.places.len() - 1;
        let place = self.places[0] + part * (self.places[last] - self.places[0]);
        let from = self
            .places
            .partition_point(|one| *one <= place)
            .clamp(1, last.max(1))
            - 1;
        let to = (from + 1).min(last);
        let step = self.places[to] - self.places[from];
        let blend = if step > 0.0 {
            ((place - self.places[from]) / step).clamp(0.0, 1.0)
        } else {
            0.0
        };
        Moment {
            from,
            to,
            blend,
            part,
            time: self.times[from] + blend * (self.times[to] - self.times[from]),
        }
    }

    /// Time from the first to the last output.
    pub fn duration(&self) -> f64 {
        self.times[self.times.len() - 1] - self.times[0]
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{options, swinging};
    use super::*;

    #[test]
    fn pictures_are_evenly_spread_from_the_first_to_the_last_output() {
        // Eleven outputs at 0, 0.1 … 1 s.
        let case = swinging(11);
        let films = [
            (Pace::Duration(2.0), 60),
            (Pace::Speed(0.25), 120),
            (Pace::Speed(10.0), 3),
            (Pace::Usual, 50),
        ];
        for (pace, pictures) in films {
            let timeline = Timeline::of(&case, &FilmOptions { pace, ..options() }).unwrap();
            assert_eq!(timeline.pictures, pictures);
            for picture in 0..pictures {
                let moment = timeline.moment(picture);
                let time = picture as f64 / (pictures - 1) as f64;
                assert!((moment.time - time).abs() < 1e-12 && (moment.part - time).abs() < 1e-12);
                let between = 0.1 * (moment.from as f64 + moment.blend);
                assert!((between - time).abs() < 1e-9, "{moment:?}");
            }
        }
    }

    #[test]
    fn rods_at_rest_are_one_picture_or_a_turn() {
        let case = swinging(1);
        let still = Timeline::of(&case, &options()).unwrap();
        assert_eq!(still.pictures, 1);
        assert_eq!(still.moment(0).from, 0);
        let turn = std::f64::consts::TAU;
        let turning = Timeline::of(&case, &FilmOptions { turn, ..options() }).unwrap();
        assert_eq!(turning.pictures, 240);
        let pace = Pace::Speed(1.0);
        let refused = Timeline::of(&case, &FilmOptions { pace, ..options() });
        assert!(matches!(refused, Err(FilmError::NoSpeed)));
    }

    #[test]
    fn endless_films_are_refused() {
        let pace = Pace::Duration(1e9);
        let refused = Timeline::of(&swinging(3), &FilmOptions { pace, ..options() });
        assert!(matches!(refused, Err(FilmError::TooLong { .. })));
    }
}

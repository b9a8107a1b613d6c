//! Movies as compact binary: positions in 16 bits of their bounding box, colours in 8 bits of their range.

use super::super::motion::{Field, MovieCase};
use nalgebra::Vector3;

/// Levels of a coordinate.
const COORDINATE_LEVELS: f64 = 65535.0;
/// Levels of a colour.
const COLOR_LEVELS: f64 = 255.0;
/// Share of the largest values that may exceed the colour range, so that a spike does not hide the
/// rest.
const CLIPPED: f64 = 0.002;

/// An axis-aligned box around the whole motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bounds {
    /// Lowest corner, m.
    pub lower: Vector3<f64>,
    /// Extents, m; never zero.
    pub size: Vector3<f64>,
}

impl Bounds {
    /// The box around all nodes and contacts at all times.
    pub fn of(case: &MovieCase) -> Self {
        let frames = case.frames.iter();
        let points = frames.flat_map(|frame| frame.positions.iter().chain(&frame.contacts));
        let (mut lower, mut upper) = (
            Vector3::repeat(f64::INFINITY),
            Vector3::repeat(f64::NEG_INFINITY),
        );
        for point in points {
            lower = lower.inf(point);
            upper = upper.sup(point);
        }
        let size = (upper - lower).map(|extent| extent.max(f64::MIN_POSITIVE.sqrt()));
        Self { lower, size }
    }

    /// Appends the quantised coordinates of a point.
    fn pack(&self, point: &Vector3<f64>, bytes: &mut Vec<u8>) {
        for axis in 0..3 {
            let part = (point[axis] - self.lower[axis]) / self.size[axis];
            let level = (COORDINATE_LEVELS * part).round() as u16;
            bytes.extend(level.to_le_bytes());
        }
    }
}

/// The values at the ends of a colour bar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ColorRange {
    pub low: f64,
    pub high: f64,
    /// Whether some values are beyond the range.
    pub clips: bool,
}

impl ColorRange {
    /// A range that shows the field well; `None` if the field is constant.
    ///
    /// The largest 0.2 % of the non-zero values may exceed it. A range without sign starts at zero
    /// unless the values vary little; a signed range is symmetric.
    pub fn of(field: &Field) -> Option<Self> {
        let all = field.values.iter().flatten().copied();
        let (minimum, maximum) = all.clone().fold(
            (f64::INFINITY, f64::NEG_INFINITY),
            |(minimum, maximum), value| (minimum.min(value), maximum.max(value)),
        );
        if !(maximum > minimum && (maximum - minimum) > 1e-9 * maximum.abs().max(minimum.abs())) {
            return None;
        }
        let mut sizes: Vec<f64> = all.map(f64::abs).filter(|size| *size > 0.0).collect();
        let index = ((1.0 - CLIPPED) * (sizes.len() - 1) as f64).ceil() as usize;
        let (_, &mut high, beyond) = sizes.select_nth_unstable_by(index, f64::total_cmp);
        let clips = beyond.iter().any(|size| *size > 1.001 * high);
        let low = if field.signed {
            -high
        } else if minimum > 0.5 * high {
            minimum
        } else {
            0.0
        };
        Some(Self { low, high, clips })
    }

    fn level(&self, value: f64) -> u8 {
        (COLOR_LEVELS * (value - self.low) / (self.high - self.low)).round() as u8
    }
}

/// The bytes of a case, little-endian, in this order (F frames, N nodes, C contacts in all):
///
/// | what | type | length |
/// |---|---|---|
/// | times, s | f32 | F |
/// | number of the first contact of each frame, and C | u32 | F + 1 |
/// | series one after the other, NaN for missing values | f32 | F for each |
/// | positions x, y, z, in levels of the bounds | u16 | 3 F N |
/// | contacts x, y, z, in levels of the bounds | u16 | 3 C |
/// | colours field by field, in levels of their ranges | u8 | F N for each field |
pub(super) fn pack(case: &MovieCase, bounds: &Bounds, fields: &[(&Field, ColorRange)]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for frame in &case.frames {
        bytes.extend((frame.time as f32).to_le_bytes());
    }
    let mut contacts = 0_u32;
    bytes.extend(contacts.to_le_bytes());
    for frame in &case.frames {
        contacts += frame.contacts.len() as u32;
        bytes.extend(contacts.to_le_bytes());
    }
    for value in case.series.iter().flat_map(|series| &series.values) {
        bytes.extend((value.unwrap_or(f64::NAN) as f32).to_le_bytes());
    }
    for point in case.frames.iter().flat_map(|frame| &frame.positions) {
        bounds.pack(point, &mut bytes);
    }
    for point in case.frames.iter().flat_map(|frame| &frame.contacts) {
        bounds.pack(point, &mut bytes);
    }
    for (field, range) in fields {
        bytes.extend(
            field
                .values
                .iter()
                .flatten()
                .map(|value| range.level(*value)),
        );
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::super::tests::spinning;
    use super::*;

    fn u16_at(bytes: &[u8], at: usize) -> f64 {
        f64::from(u16::from_le_bytes([bytes[at], bytes[at + 1]]))
    }

    #[test]
    fn positions_unpack_to_a_level_of_the_box() {
        let case = spinning();
        let bounds = Bounds::of(&case);
        let (frames, nodes) = (case.frames.len(), case.frames[0].positions.len());
        let bytes = pack(&case, &bounds, &[]);
        let positions = 4 * frames + 4 * (frames + 1) + 4 * frames * case.series.len();
        let contacts: usize = case.frames.iter().map(|frame| frame.contacts.len()).sum();
        assert_eq!(bytes.len(), positions + 6 * frames * nodes + 6 * contacts);
        for (index, point) in case.frames.iter().flat_map(|f| &f.positions).enumerate() {
            for axis in 0..3 {
                let level = u16_at(&bytes, positions + 6 * index + 2 * axis);
                let read = bounds.lower[axis] + bounds.size[axis] * level / COORDINATE_LEVELS;
                let error = (read - point[axis]).abs();
                assert!(
                    error <= 0.501 * bounds.size[axis] / COORDINATE_LEVELS,
                    "{error}"
                );
            }
        }
    }

    fn field(signed: bool, values: &[f64]) -> Field {
        Field {
            name: "x".into(),
            unit: "m".into(),
            signed,
            values: vec![values.to_vec()],
        }
    }

    #[test]
    fn color_ranges_show_the_field() {
        let range = |signed, values: &[f64]| {
            ColorRange::of(&field(signed, values)).map(|r| (r.low, r.high))
        };
        assert_eq!(range(false, &[0.0, 1.0, 4.0]), Some((0.0, 4.0)));
        assert_eq!(range(false, &[3.0, 3.5, 4.0]), Some((3.0, 4.0)));
        assert_eq!(range(true, &[-3.0, 1.0, 2.0]), Some((-3.0, 3.0)));
        assert_eq!(range(false, &[2.0, 2.0]), None);
        assert_eq!(range(true, &[0.0, 0.0]), None);
    }

    #[test]
    fn a_spike_is_clipped_and_zeros_do_not_count() {
        let mut values = vec![0.0; 5000];
        values.extend((0..2000).map(|k| 1.0 + f64::from(k) / 2000.0));
        values[10] = 1e6;
        let range = ColorRange::of(&field(false, &values)).unwrap();
        assert!(
            range.low == 0.0 && range.high > 1.9 && range.high < 2.0,
            "{range:?}"
        );
        assert!(range.clips);
        assert_eq!(
            (range.level(0.0), range.level(1e6), range.level(range.high)),
            (0, 255, 255)
        );
    }
}

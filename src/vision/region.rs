//! The part of a picture that is searched: a rectangle or a polygon.

use super::contrast::Contrast;
use super::mask::Mask;
use super::{Point, VisionError};
use image::{RgbImage, imageops};

/// A region of an image, bounded by a polygon. Strands are cut at its edge.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// Corners in order, pixels; at least three.
    corners: Vec<Point>,
}

/// Columns and rows of a rectangle, inside an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Frame {
    /// First column and row.
    pub origin: [u32; 2],
    /// Columns and rows; at least one each.
    pub size: [u32; 2],
}

impl Region {
    /// Parses `x,y,width,height`, or the corners of a polygon as `x,y x,y x,y`, in pixels.
    ///
    /// # Errors
    /// [`VisionError::Region`] with the allowed forms.
    pub fn parse(text: &str) -> Result<Self, VisionError> {
        let fault = |reason| VisionError::Region {
            text: text.into(),
            reason,
        };
        let groups: Vec<&str> = text.split_whitespace().collect();
        let parsed: Option<Vec<Vec<f64>>> = groups.iter().map(|group| numbers(group)).collect();
        let parsed = parsed.ok_or_else(|| fault(FORMS))?;
        if let [rectangle] = &parsed[..] {
            let [x, y, width, height] = rectangle[..] else {
                return Err(fault(FORMS));
            };
            if width < 1.0 || height < 1.0 {
                return Err(fault("its width and height are at least 1"));
            }
            let (right, below) = (x + width - 1.0, y + height - 1.0);
            let corners = [[x, y], [right, y], [right, below], [x, below]];
            return Ok(Self {
                corners: corners.map(Point::from).to_vec(),
            });
        }
        let corners: Option<Vec<Point>> = parsed
            .iter()
            .map(|corner| Some(Point::from(<[f64; 2]>::try_from(&corner[..]).ok()?)))
            .collect();
        let corners = corners.filter(|corners| corners.len() >= 3);
        let corners = corners.ok_or_else(|| fault(FORMS))?;
        Ok(Self { corners })
    }

    /// The region inside a polygon with at least three corners, pixels.
    pub fn polygon(corners: Vec<Point>) -> Option<Self> {
        (corners.len() >= 3).then_some(Self { corners })
    }

    /// Whether a pixel lies in the region or on its edge.
    pub fn contains(&self, pixel: Point) -> bool {
        let count = self.corners.len();
        let mut inside = false;
        for index in 0..count {
            let (a, b) = (self.corners[index], self.corners[(index + 1) % count]);
            let (along, away) = (b - a, pixel - a);
            let height = along.perp(&away);
            let foot = along.dot(&away);
            if height.abs() <= 1e-9 * along.norm() && foot >= 0.0 && foot <= along.norm_squared() {
                return true;
            }
            // Count the edges that a ray to the left crosses.
            if (a.y > pixel.y) != (b.y > pixel.y) {
                let x = a.x + (pixel.y - a.y) / (b.y - a.y) * (b.x - a.x);
                inside ^= x < pixel.x;
            }
        }
        inside
    }

    /// The part of an image around the region.
    ///
    /// # Errors
    /// The region lies outside of the image.
    pub(super) fn frame(&self, width: u32, height: u32) -> Result<Frame, VisionError> {
        let range = |of: fn(&Point) -> f64, size: u32| {
            let values = || self.corners.iter().map(of);
            let low = values().fold(f64::INFINITY, f64::min).max(0.0);
            let high = values().fold(f64::NEG_INFINITY, f64::max);
            let high = high.min(f64::from(size) - 1.0);
            (low <= high).then(|| {
                let first = low.floor() as u32;
                (first, high.ceil() as u32 - first + 1)
            })
        };
        match (
            range(|corner| corner.x, width),
            range(|corner| corner.y, height),
        ) {
            (Some((left, columns)), Some((top, rows))) => Ok(Frame {
                origin: [left, top],
                size: [columns, rows],
            }),
            _ => Err(VisionError::OutsideRegion { width, height }),
        }
    }

    /// Removes the contrast outside of the region, for an image that was cut out at `frame`.
    pub(super) fn limit(&self, contrast: &mut Contrast, frame: Frame) {
        let [left, top] = frame.origin.map(f64::from);
        for (row, values) in contrast
            .values
            .chunks_exact_mut(contrast.width.max(1))
            .enumerate()
        {
            for (column, value) in values.iter_mut().enumerate() {
                let pixel = Point::new(column as f64 + left, row as f64 + top);
                if *value > 0 && !self.contains(pixel) {
                    *value = 0;
                }
            }
        }
    }
}

const FORMS: &str = "expected x,y,width,height, or the corners of a polygon as \"x,y x,y x,y\", \
                     in pixels from 0";

/// Numbers between commas; none is negative.
fn numbers(text: &str) -> Option<Vec<f64>> {
    let number = |text: &str| text.parse().ok().filter(|x: &f64| *x >= 0.0 && *x < 1e6);
    text.split(',').map(number).collect()
}

impl Frame {
    /// The pixels of an image inside the frame.
    pub fn cut(self, picture: &RgbImage) -> RgbImage {
        let ([left, top], [width, height]) = (self.origin, self.size);
        imageops::crop_imm(picture, left, top, width, height).to_image()
    }

    /// The values of a contrast image inside the frame.
    pub fn cut_contrast(self, contrast: &Contrast) -> Contrast {
        let [left, top] = self.origin.map(|first| first as usize);
        let [width, height] = self.size.map(|size| size as usize);
        let rows = contrast.values.chunks_exact(contrast.width.max(1));
        Contrast {
            width,
            height,
            values: rows
                .skip(top)
                .take(height)
                .flat_map(|row| &row[left..left + width])
                .copied()
                .collect(),
            threshold: contrast.threshold,
        }
    }

    /// A mask of the whole image.
    pub fn paste_mask(self, mask: &Mask, size: [u32; 2]) -> Mask {
        let [left, top] = self.origin.map(|first| first as usize);
        let mut whole = Mask::new(size[0] as usize, size[1] as usize);
        for index in mask.members() {
            let (column, row) = mask.position(index);
            whole.set(column + left, row + top, true);
        }
        whole
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_rectangle_contains_exactly_its_pixels() {
        let region = Region::parse("10,20,5,3").expect("a region");
        let inside = (0..40)
            .flat_map(|v| (0..40).map(move |u| Point::new(f64::from(u), f64::from(v))))
            .filter(|pixel| region.contains(*pixel));
        assert_eq!(inside.count(), 15);
        let frame = region.frame(100, 100).expect("inside");
        assert_eq!((frame.origin, frame.size), ([10, 20], [5, 3]));
    }

    #[test]
    fn a_polygon_may_be_concave() {
        let region = Region::parse("0,0 20,0 20,20 10,5 0,20").expect("a region");
        assert!(region.contains(Point::new(3.0, 10.0)) && region.contains(Point::new(17.0, 10.0)));
        assert!(!region.contains(Point::new(10.0, 10.0)));
    }

    #[test]
    fn a_region_is_cut_off_at_the_image_or_rejected() {
        let region = Region::parse("90,0,50,10").expect("a region");
        let frame = region.frame(100, 5).expect("partly inside");
        assert_eq!((frame.origin, frame.size), ([90, 0], [10, 5]));
        assert!(region.frame(80, 80).is_err());
    }

    #[test]
    fn faulty_regions_are_rejected_with_the_allowed_forms() {
        for text in [
            "",
            "1,2,3",
            "1,2,0,4",
            "1,2,3,4,5",
            "1,2 3,4",
            "a,b,c,d",
            "1,2,3,-4",
            "1,2 3,4 5,6,7",
            "nan,0,5,5",
        ] {
            let error = Region::parse(text).expect_err("a fault").to_string();
            assert!(error.contains("region") && error.contains(text), "{error}");
        }
    }

    proptest! {
        #[test]
        fn what_is_written_is_read(
            x in 0u32..5000, y in 0u32..5000, width in 1u32..5000, height in 1u32..5000,
        ) {
            let region = Region::parse(&format!("{x},{y},{width},{height}")).expect("a region");
            let frame = region.frame(20_000, 20_000).expect("inside");
            prop_assert_eq!(frame, Frame { origin: [x, y], size: [width, height] });
        }

        #[test]
        fn any_text_is_read_or_rejected(text in ".{0,40}") {
            if let Ok(region) = Region::parse(&text) {
                prop_assert!(region.corners.len() >= 3);
            }
        }
    }
}

//! Finds a rod on the table in a picture of the camera, as a curve in the frame of its pattern.

use super::error::WorkError;
use super::workplace::Workplace;
use crate::cell::Cell;
use image::RgbImage;
use rodlab_robot::Pose;
use rodlab_vision::{
    Camera, ColourRule, Point, Region, Trace, TraceOptions, VisionError, centrelines_csv,
    encode_picture, overlay, trace, whole_rod,
};

/// Least distance from the border of a picture at which an end counts as visible, pixels.
const BORDER: f64 = 2.0;

/// The strands of a picture, and the camera that saw them.
pub struct Seen {
    /// The strands.
    pub trace: Trace,
    camera: Camera,
    /// Transformation from the cell to the frame of the pattern, and height of the centreline in
    /// the cell, m.
    to_frame: Pose,
    height: f64,
}

/// The top of the table in a picture, if the picture shows something beside it.
fn table_in(cell: &Cell, camera: &Camera) -> Option<Region> {
    let table = cell.table?;
    let [x, y] = [0.5 * table.size[0], 0.5 * table.size[1]];
    let corners = [[-x, -y], [x, -y], [x, y], [-x, y]];
    let pixels = corners.map(|[x, y]| {
        let corner = table.top * nalgebra::Point3::new(x, y, 0.0);
        camera.project(corner.coords)
    });
    let region = Region::polygon(pixels.into_iter().collect::<Option<Vec<_>>>()?)?;
    let [right, below] = [camera.width, camera.height].map(|pixels| f64::from(pixels) - 1.0);
    let ends = [[0.0, 0.0], [right, 0.0], [right, below], [0.0, below]];
    let is_whole = ends.iter().all(|end| region.contains(Point::from(*end)));
    (!is_whole).then_some(region)
}

impl Seen {
    /// Finds rods with a given radius, m, and colour on the table in a picture. What the picture
    /// shows beside the table is left out.
    ///
    /// # Errors
    /// No strand is found, or the picture has another size than the camera.
    pub fn of(
        picture: &RgbImage,
        cell: &Cell,
        frame: &Pose,
        radius: f64,
        colour: &ColourRule,
    ) -> Result<Self, VisionError> {
        let missing = VisionError::Undetermined {
            problem: "the rod",
            reason: "the cell has no [camera]".into(),
        };
        let camera = cell.camera.as_ref().ok_or(missing)?;
        // The centreline lies a radius above the table.
        let height = frame.translation.z + radius;
        let camera = camera.seeing(height);
        camera.check_size(picture.width(), picture.height())?;
        let options = TraceOptions {
            colour: colour.clone(),
            region: table_in(cell, &camera),
            ..TraceOptions::default()
        };
        Ok(Self {
            trace: trace(picture, &options)?,
            camera,
            to_frame: frame.inverse(),
            height,
        })
    }

    /// Writes the picture with the strands, `overlay.png`, and the strands, `centrelines.csv`.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(&self, picture: &RgbImage, at: &Workplace<'_>) -> Result<(), WorkError> {
        let shown = encode_picture(&overlay(picture, &self.trace));
        at.write("overlay.png", &shown)?;
        let strands = centrelines_csv(&self.trace.strands, None);
        at.write(
            "centrelines.csv",
            strands.map_err(WorkError::failed)?.as_bytes(),
        )
    }

    /// The longest strand in the frame of the pattern, m, from the end that is nearer to `start`,
    /// joined with the closed strands that it crosses. The picture must show a single rod.
    ///
    /// # Errors
    /// A pixel shows no point of the table.
    pub fn longest(&self, start: Point) -> Result<Vec<Point>, VisionError> {
        self.curve(self.longest_index(), start)
    }

    /// Whether the longest strand, from the end that is nearer to `start`, leaves the picture.
    ///
    /// # Errors
    /// A pixel shows no point of the table.
    pub fn leaves_picture(&self, start: Point) -> Result<bool, VisionError> {
        let index = self.longest_index();
        let margin = self.trace.strands[index].width().max(BORDER);
        let [width, height] = [self.camera.width, self.camera.height].map(f64::from);
        let is_at_border = |pixel: &Point| {
            let sides = [
                pixel.x,
                pixel.y,
                width - 1.0 - pixel.x,
                height - 1.0 - pixel.y,
            ];
            sides.iter().any(|away| *away < margin)
        };
        Ok(self.pixels(index, start)?.last().is_some_and(is_at_border))
    }

    /// Strands in the picture and their widths, pixels: one for each rod, from the start of the
    /// rod. A single rod is the longest strand; several rods are the strands that begin nearest to
    /// `starts`. Fewer are returned if the picture has fewer strands.
    ///
    /// # Errors
    /// A pixel shows no point of the table.
    pub fn in_picture(&self, starts: &[Point]) -> Result<Vec<(Vec<Point>, f64)>, VisionError> {
        let mut taken = Vec::new();
        for start in starts {
            let index = match starts {
                [_] => Some(self.longest_index()),
                _ => self.nearest_index(*start, &taken)?,
            };
            taken.extend(index);
        }
        let strands = taken.iter().zip(starts).map(|(index, start)| {
            let width = self.trace.strands[*index].width();
            Ok((self.pixels(*index, *start)?, width))
        });
        strands.collect()
    }

    /// The strand that begins nearest to `start`, except the strands in `but`.
    fn nearest_index(&self, start: Point, but: &[usize]) -> Result<Option<usize>, VisionError> {
        let mut nearest: Option<(f64, usize)> = None;
        for (index, strand) in self.trace.strands.iter().enumerate() {
            for end in [strand.points.first(), strand.points.last()] {
                let Some(end) = end.filter(|_| !but.contains(&index)) else {
                    continue;
                };
                let away = (self.place(*end)? - start).norm();
                if nearest.is_none_or(|(least, _)| away < least) {
                    nearest = Some((away, index));
                }
            }
        }
        Ok(nearest.map(|(_, index)| index))
    }

    fn longest_index(&self) -> usize {
        let strands = self.trace.strands.iter().enumerate();
        // If no strand is open, the rod closes upon itself.
        let longest = strands.max_by(|(_, a), (_, b)| {
            let openness = b.closed.cmp(&a.closed);
            openness.then(a.length().total_cmp(&b.length()))
        });
        let (index, _) = longest.expect("a trace has strands");
        index
    }

    /// The strand that begins nearest to `start`, in the frame of the pattern, m, from its nearer
    /// end.
    ///
    /// # Errors
    /// A pixel shows no point of the table.
    pub fn from(&self, start: Point) -> Result<Vec<Point>, VisionError> {
        let curves = (0..self.trace.strands.len()).map(|index| self.curve(index, start));
        let curves = curves.collect::<Result<Vec<_>, _>>()?;
        let away = |curve: &Vec<Point>| curve.first().map_or(0.0, |point| (point - start).norm());
        let nearest = curves
            .into_iter()
            .min_by(|a, b| away(a).total_cmp(&away(b)));
        Ok(nearest.unwrap_or_default())
    }

    /// A strand in the frame of the pattern, m, from the end that is nearer to `start`.
    fn curve(&self, index: usize, start: Point) -> Result<Vec<Point>, VisionError> {
        let pixels = self.pixels(index, start)?.into_iter();
        pixels.map(|pixel| self.place(pixel)).collect()
    }

    /// A strand in the picture, pixels, from the end that is nearer to `start`.
    fn pixels(&self, index: usize, start: Point) -> Result<Vec<Point>, VisionError> {
        let Trace {
            strands, crossings, ..
        } = &self.trace;
        let ends = [strands[index].points.first(), strands[index].points.last()];
        let mut away = [0.0; 2];
        for (away, end) in away.iter_mut().zip(ends) {
            *away = match end {
                Some(pixel) => (self.place(*pixel)? - start).norm(),
                None => 0.0,
            };
        }
        Ok(whole_rod(strands, crossings, index, away[1] < away[0]))
    }

    /// Converts a pixel to a place in the frame of the pattern, m.
    pub fn place(&self, pixel: Point) -> Result<Point, VisionError> {
        let place = self.camera.on_table(pixel)?;
        let place = self.to_frame * nalgebra::Point3::new(place.x, place.y, self.height);
        Ok(Point::new(place.x, place.y))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_cells::gantry;
    use image::Rgb;

    /// A dark picture with a short bar in its middle and a long one at its upper edge.
    fn picture(camera: &Camera) -> RgbImage {
        let mut picture = RgbImage::from_pixel(camera.width, camera.height, Rgb([40, 44, 48]));
        let mut bar = |row: u32, columns: std::ops::Range<u32>| {
            for (x, y) in columns.flat_map(|x| (row..row + 8).map(move |y| (x, y))) {
                picture.put_pixel(x, y, Rgb([205, 60, 70]));
            }
        };
        bar(camera.height / 2, 500..800);
        bar(20, 100..1100);
        picture
    }

    #[test]
    fn what_lies_beside_the_table_is_left_out() {
        let mut cell = gantry();
        let camera = cell.camera.as_ref().unwrap().seeing(0.0);
        let picture = picture(&camera);
        let seen = |cell: &Cell| {
            let seen = Seen::of(
                &picture,
                cell,
                &Pose::identity(),
                0.0,
                &ColourRule::Background,
            );
            seen.unwrap().trace.strands.len()
        };
        // The table is larger than the picture.
        assert_eq!((table_in(&cell, &camera), seen(&cell)), (None, 2));
        let table = cell.table.as_mut().unwrap();
        table.size = [0.6, 0.5, 0.04];
        assert_eq!(seen(&cell), 1);
        cell.table = None;
        assert_eq!(seen(&cell), 2);
    }
}

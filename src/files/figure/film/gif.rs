//! A film as GIF, with one palette for all pictures and only the changed part of each picture.

use super::{Film, FilmError};
use color_quant::NeuQuant;
use gif::{DisposalMethod, Encoder, EncodingError, Frame, Repeat};
use rayon::prelude::*;
use std::borrow::Cow;
use std::collections::BTreeMap;

/// Index of the colour for unchanged pixels; the last two colours before it are white and black.
const UNCHANGED: u8 = 255;
const LEARNT: usize = 253;
/// Number of pictures from which the palette is computed.
const SAMPLED: usize = 6;
/// Bits per channel of the lookup of the nearest colour.
const BITS: u32 = 6;
/// Maximum number of pictures per second in browsers.
const FASTEST: f64 = 50.0;

impl Film<'_> {
    /// Encodes the film as a repeating GIF.
    ///
    /// `watch` is called with the number of pictures done, and returns whether to continue.
    ///
    /// # Errors
    /// [`FilmError::TooFast`], [`FilmError::Interrupted`], [`FilmError::Encoding`].
    pub fn gif(&self, watch: &(dyn Fn(usize) -> bool + Sync)) -> Result<Vec<u8>, FilmError> {
        if self.pictures_per_second > FASTEST {
            return Err(FilmError::TooFast);
        }
        let fault = |error: EncodingError| FilmError::Encoding(error.to_string());
        let palette = Palette::of(&self.some_pictures(SAMPLED));
        let [width, height] = self.size;
        let mut bytes = Vec::new();
        let encoder = Encoder::new(&mut bytes, width as u16, height as u16, &palette.colours);
        let mut encoder = encoder.map_err(fault)?;
        encoder.set_repeat(Repeat::Infinite).map_err(fault)?;
        let mut shown: Vec<u8> = Vec::new();
        let mut number = 0;
        let take = |numbers: Vec<u8>| {
            // Times are in hundredths of a second; rounding errors are carried to the next picture.
            let time = |picture: usize| (100.0 * picture as f64 / self.pictures_per_second).round();
            let delay = (time(number + 1) - time(number)) as u16;
            number += 1;
            let frame = changes(&shown, &numbers, width);
            shown = numbers;
            encoder
                .write_frame(&Frame { delay, ..frame })
                .map_err(fault)
        };
        self.each_picture(watch, |pixels| palette.numbers(pixels), take)?;
        drop(encoder);
        Ok(bytes)
    }
}

/// The rectangle in which a picture differs from the previous one, with equal pixels marked as
/// unchanged.
fn changes(before: &[u8], after: &[u8], width: usize) -> Frame<'static> {
    let frame = |rectangle: [usize; 4], buffer: Vec<u8>| Frame {
        left: rectangle[0] as u16,
        top: rectangle[1] as u16,
        width: rectangle[2] as u16,
        height: rectangle[3] as u16,
        buffer: Cow::Owned(buffer),
        transparent: Some(UNCHANGED),
        dispose: DisposalMethod::Keep,
        ..Frame::default()
    };
    if before.len() != after.len() {
        return frame([0, 0, width, after.len() / width], after.to_vec());
    }
    let (mut left, mut right, mut top, mut bottom) = (width, 0, usize::MAX, 0);
    for (row, (a, b)) in before
        .chunks_exact(width)
        .zip(after.chunks_exact(width))
        .enumerate()
    {
        if a == b {
            continue;
        }
        let differs = |column: &usize| a[*column] != b[*column];
        left = left.min((0..width).find(differs).unwrap_or(width));
        right = right.max((0..width).rfind(differs).map_or(0, |last| last + 1));
        (top, bottom) = (top.min(row), row + 1);
    }
    if top == usize::MAX {
        // A frame has at least one pixel.
        return frame([0, 0, 1, 1], vec![UNCHANGED]);
    }
    let mut buffer = Vec::with_capacity((right - left) * (bottom - top));
    for row in top..bottom {
        let columns = row * width + left..row * width + right;
        let pairs = before[columns.clone()].iter().zip(&after[columns]);
        buffer.extend(pairs.map(|(a, b)| if a == b { UNCHANGED } else { *b }));
    }
    frame([left, top, right - left, bottom - top], buffer)
}

/// The colours of a film.
struct Palette {
    /// Red, green, blue of each.
    colours: Vec<u8>,
    /// Index of the nearest colour by the leading bits of red, green and blue.
    nearest: Vec<u8>,
}

impl Palette {
    /// The best palette for some pictures.
    fn of(pictures: &[Vec<u8>]) -> Self {
        let mut counts: BTreeMap<[u8; 3], u32> = BTreeMap::new();
        for pixel in pictures.iter().flat_map(|pixels| pixels.chunks_exact(3)) {
            *counts.entry([pixel[0], pixel[1], pixel[2]]).or_default() += 1;
        }
        // Rare colours have more weight than their share; otherwise all colours would be similar
        // to the background.
        let weighted = counts.iter().flat_map(|([red, green, blue], count)| {
            let weight = f64::from(*count).sqrt().ceil().min(48.0) as usize;
            std::iter::repeat_n([*red, *green, *blue, 255], weight)
        });
        let learnt = NeuQuant::new(1, LEARNT, &weighted.flatten().collect::<Vec<u8>>());
        let mut colours = learnt.color_map_rgb();
        colours.truncate(3 * LEARNT);
        colours.extend([255; 3]);
        colours.extend([0; 6]);
        let cells = 1_usize << (3 * BITS);
        let nearest = (0..cells).into_par_iter().map(|cell| {
            let level = |channel: u32| {
                let bits = (cell >> (BITS * channel)) & ((1 << BITS) - 1);
                // Both ends are exact: white stays white.
                bits as i32 * 255 / ((1 << BITS) - 1)
            };
            let wanted = [level(2), level(1), level(0)];
            let distance = |colour: &[u8]| {
                let parts = (0..3).map(|k| i32::from(colour[k]) - wanted[k]);
                parts.map(|part| part * part).sum::<i32>()
            };
            let usable = colours.chunks_exact(3).take(usize::from(UNCHANGED));
            let best = usable
                .enumerate()
                .min_by_key(|(_, colour)| distance(colour));
            best.map_or(0, |(number, _)| number as u8)
        });
        Self {
            nearest: nearest.collect(),
            colours,
        }
    }

    /// The index of the nearest colour of each pixel.
    fn numbers(&self, pixels: &[u8]) -> Vec<u8> {
        let leading = |channel: u8| usize::from(channel >> (8 - BITS));
        let cell = |pixel: &[u8]| {
            leading(pixel[0]) << (2 * BITS) | leading(pixel[1]) << BITS | leading(pixel[2])
        };
        let cells = pixels.chunks_exact(3).map(cell);
        cells.map(|cell| self.nearest[cell]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{options, swinging};
    use super::super::{FilmOptions, Pace};
    use super::*;
    use gif::{ColorOutput, DecodeOptions};

    fn film_options() -> FilmOptions {
        FilmOptions {
            pace: Pace::Duration(0.5),
            pictures_per_second: 15.0,
            ..options()
        }
    }

    #[test]
    fn the_gif_has_the_pictures_their_times_and_their_colours() {
        let case = swinging(11);
        let film = Film::new(&case, &film_options()).unwrap();
        let bytes = film.gif(&|_| true).unwrap();
        let mut options = DecodeOptions::new();
        options.set_color_output(ColorOutput::Indexed);
        let mut decoder = options.read_info(&bytes[..]).unwrap();
        let colours = decoder.global_palette().unwrap().to_vec();
        let [width, height] = film_options().size;
        let mut seen = vec![0_u8; width * height];
        let (mut pictures, mut hundredths) = (0, 0);
        let mut last = Vec::new();
        while let Some(frame) = decoder.read_next_frame().unwrap() {
            pictures += 1;
            hundredths += u32::from(frame.delay);
            for (at, number) in frame.buffer.iter().enumerate() {
                let row = usize::from(frame.top) + at / usize::from(frame.width);
                let column = usize::from(frame.left) + at % usize::from(frame.width);
                if *number != UNCHANGED {
                    seen[row * width + column] = *number;
                }
            }
            last.clone_from(&seen);
        }
        assert_eq!((pictures, hundredths), (8, 53));
        let shown = last
            .iter()
            .flat_map(|number| &colours[3 * usize::from(*number)..][..3]);
        let drawn = &film.some_pictures(2)[1];
        let errors = drawn
            .iter()
            .zip(shown)
            .map(|(a, b)| f64::from(a.abs_diff(*b)).powi(2));
        let mean = errors.sum::<f64>() / drawn.len() as f64;
        assert!(mean < 12.0, "{mean}");
    }

    #[test]
    fn films_are_the_same_bytes_with_any_number_of_threads_and_end_when_asked() {
        let case = swinging(11);
        let film = Film::new(&case, &film_options()).unwrap();
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            pool.install(|| film.gif(&|_| true)).unwrap()
        };
        assert_eq!(with(1), with(4));
        let interrupted = film.gif(&|done| done < 3);
        assert!(matches!(interrupted, Err(FilmError::Interrupted)));
    }
}

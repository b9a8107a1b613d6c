//! The pictures of a film as PNG.

use super::{Film, FilmError};
use png::{BitDepth, ColorType, Compression, Encoder};

impl Film<'_> {
    /// Passes on each picture as PNG in order. `watch`: see [`Film::gif`].
    ///
    /// # Errors
    /// [`FilmError::Interrupted`], or what `take` returns.
    pub fn png_pictures(
        &self,
        watch: &(dyn Fn(usize) -> bool + Sync),
        mut take: impl FnMut(Vec<u8>) -> Result<(), FilmError> + Send,
    ) -> Result<(), FilmError> {
        self.each_picture(watch, |pixels| self.png(pixels), |picture| take(picture?))
    }

    fn png(&self, pixels: &[u8]) -> Result<Vec<u8>, FilmError> {
        let mut bytes = Vec::new();
        let [width, height] = self.size.map(|side| side as u32);
        let mut encoder = Encoder::new(&mut bytes, width, height);
        encoder.set_color(ColorType::Rgb);
        encoder.set_depth(BitDepth::Eight);
        encoder.set_compression(Compression::Balanced);
        let fault = |error: png::EncodingError| FilmError::Encoding(error.to_string());
        let mut writer = encoder.write_header().map_err(fault)?;
        writer.write_image_data(pixels).map_err(fault)?;
        writer.finish().map_err(fault)?;
        Ok(bytes)
    }
}

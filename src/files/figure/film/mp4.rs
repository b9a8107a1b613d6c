//! A film as MP4 with H.264, which all browsers and presentation programs play.

use super::{Film, FilmError};
use openh264::OpenH264API;
use openh264::encoder::{
    Encoder, EncoderConfig, FrameRate, FrameType, IntraFramePeriod, Profile, QpRange,
    RateControlMode, VuiConfig,
};
use openh264::formats::{RgbSliceU8, YUVBuffer};
use shiguredo_mp4::TrackKind;
use shiguredo_mp4::bitstream::h264::{
    H264SampleEntryConfig, LengthSize, annexb_to_length_prefixed, build_avc1_box_from_annexb,
};
use shiguredo_mp4::boxes::SampleEntry;
use shiguredo_mp4::mux::{Mp4FileMuxer, Sample};
use std::fmt::Display;
use std::num::NonZeroU32;

/// Clock ticks of the file per second.
const TICKS: u32 = 90_000;
/// Quantiser of the encoder, low enough to preserve fine lines.
const COARSENESS: QpRange = QpRange::new(10, 24);
/// Seconds between key frames, to which players can jump.
const WHOLE_EVERY: f64 = 2.0;

impl Film<'_> {
    /// The film as MP4. `watch`: see [`Film::gif`].
    ///
    /// # Errors
    /// [`FilmError::Interrupted`], [`FilmError::Encoding`].
    pub fn mp4(&self, watch: &(dyn Fn(usize) -> bool + Sync)) -> Result<Vec<u8>, FilmError> {
        let mut file = Mp4File::new(self.pictures_per_second)?;
        let [width, height] = self.size;
        let yuv =
            |pixels: &[u8]| YUVBuffer::from_rgb_source(RgbSliceU8::new(pixels, (width, height)));
        self.each_picture(watch, yuv, |picture| file.add(&picture))?;
        file.finish()
    }
}

/// A file under construction.
struct Mp4File {
    encoder: Encoder,
    muxer: Mp4FileMuxer,
    bytes: Vec<u8>,
    pictures: u32,
    ticks_per_picture: f64,
}

impl Mp4File {
    fn new(pictures_per_second: f64) -> Result<Self, FilmError> {
        let config = EncoderConfig::new()
            .max_frame_rate(FrameRate::from_hz(pictures_per_second as f32))
            .rate_control_mode(RateControlMode::Off)
            .qp(COARSENESS)
            .intra_frame_period(IntraFramePeriod::from_num_frames(
                (WHOLE_EVERY * pictures_per_second).ceil() as u32,
            ))
            .profile(Profile::High)
            .skip_frames(false)
            .vui(VuiConfig::bt601())
            // One thread: pictures are drawn in parallel instead, and results do not depend on the
            // number of threads.
            .num_threads(1);
        let encoder =
            Encoder::with_api_config(OpenH264API::from_source(), config).map_err(fault)?;
        let muxer = Mp4FileMuxer::new().map_err(fault)?;
        Ok(Self {
            bytes: muxer.initial_boxes_bytes().to_vec(),
            encoder,
            muxer,
            pictures: 0,
            ticks_per_picture: f64::from(TICKS) / pictures_per_second,
        })
    }

    fn add(&mut self, picture: &YUVBuffer) -> Result<(), FilmError> {
        let encoded = self.encoder.encode(picture).map_err(fault)?;
        let keyframe = matches!(encoded.frame_type(), FrameType::IDR | FrameType::I);
        let stream = encoded.to_vec();
        let sample_entry = if self.pictures == 0 {
            let config = H264SampleEntryConfig {
                length_size: LengthSize::FourBytes,
            };
            let entry = build_avc1_box_from_annexb(&stream, &config).map_err(fault)?;
            Some(SampleEntry::Avc1(entry))
        } else {
            None
        };
        let data = annexb_to_length_prefixed(&stream, LengthSize::FourBytes).map_err(fault)?;
        let tick = |picture: u32| (self.ticks_per_picture * f64::from(picture)).round() as u32;
        let sample = Sample {
            track_kind: TrackKind::Video,
            sample_entry,
            keyframe,
            timescale: NonZeroU32::new(TICKS).unwrap_or(NonZeroU32::MIN),
            duration: tick(self.pictures + 1) - tick(self.pictures),
            composition_time_offset: None,
            data_offset: self.bytes.len() as u64,
            data_size: data.len(),
        };
        self.muxer.append_sample(&sample).map_err(fault)?;
        self.bytes.extend(data);
        self.pictures += 1;
        Ok(())
    }

    fn finish(mut self) -> Result<Vec<u8>, FilmError> {
        let boxes = self.muxer.finalize().map_err(fault)?;
        for (offset, part) in boxes.offset_and_bytes_pairs() {
            let (first, end) = (offset as usize, offset as usize + part.len());
            if end > self.bytes.len() {
                self.bytes.resize(end, 0);
            }
            self.bytes[first..end].copy_from_slice(part);
        }
        Ok(self.bytes)
    }
}

fn fault(error: impl Display) -> FilmError {
    FilmError::Encoding(format!("the video cannot be encoded: {error}"))
}

#[cfg(test)]
mod tests {
    use super::super::tests::{options, swinging};
    use super::super::{FilmOptions, Pace};
    use super::*;
    use openh264::decoder::Decoder;
    use openh264::formats::YUVSource;
    use shiguredo_mp4::bitstream::h264::length_prefixed_to_annexb;
    use shiguredo_mp4::demux::{Input, Mp4FileDemuxer};

    #[test]
    fn the_mp4_has_the_pictures_and_their_times() {
        let case = swinging(11);
        let options = FilmOptions {
            pace: Pace::Duration(0.5),
            ..options()
        };
        let film = Film::new(&case, &options).unwrap();
        let bytes = film.mp4(&|_| true).unwrap();
        let mut demuxer = Mp4FileDemuxer::new();
        demuxer.handle_input(Input {
            position: 0,
            data: &bytes,
        });
        let mut decoder = Decoder::new().unwrap();
        let drawn = film.some_pictures(15);
        let (mut pictures, mut ticks) = (0, 0);
        while let Some(sample) = demuxer.next_sample().unwrap() {
            let first = sample.data_offset as usize;
            let data = &bytes[first..first + sample.data_size];
            let stream = length_prefixed_to_annexb(data, LengthSize::FourBytes).unwrap();
            let picture = decoder.decode(&stream).unwrap().expect("a picture");
            assert_eq!(picture.dimensions(), (320, 180));
            let mut shown = vec![0; 3 * 320 * 180];
            picture.write_rgb8(&mut shown);
            let pairs = shown.iter().zip(&drawn[pictures]);
            let error: f64 = pairs.map(|(a, b)| f64::from(a.abs_diff(*b)).powi(2)).sum();
            let mean = error / shown.len() as f64;
            // More than 33 dB.
            assert!(mean < 255.0 * 255.0 / 2000.0, "{pictures}: {mean}");
            pictures += 1;
            ticks += sample.duration;
        }
        assert_eq!((pictures, ticks), (15, TICKS / 2));
    }
}

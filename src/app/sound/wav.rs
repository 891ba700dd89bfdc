//! A sound file: RIFF/WAVE, two channels of 16 bits (Microsoft & IBM 1991, "Multimedia programming interface").

use std::{
    io::{self, BufWriter, Seek as _, SeekFrom, Write as _},
    path::{Path, PathBuf},
};

use atomic_write_file::AtomicWriteFile;

use crate::measure::whole_file::{self, FileError};

/// Samples per second and channel.
pub const RATE_HZ: u32 = 48_000;
const CHANNELS: u16 = 2;
const BYTES_PER_SAMPLE: u16 = 2;
const BYTES_PER_MOMENT: u32 = (CHANNELS * BYTES_PER_SAMPLE) as u32;
const HEAD: usize = 44;

/// A sound file that appears when it is complete.
pub struct WavFile {
    path: PathBuf,
    file: BufWriter<AtomicWriteFile>,
    moments: u32,
}

impl WavFile {
    /// # Errors
    /// [`FileError`] when the file cannot be written.
    pub fn create(path: &Path) -> Result<Self, FileError> {
        let mut file = BufWriter::new(whole_file::open(path)?);
        file.write_all(&[0; HEAD])
            .map_err(|reason| FileError::writing(path, reason))?;
        Ok(Self {
            path: path.to_owned(),
            file,
            moments: 0,
        })
    }

    /// Adds samples of the left and the right ear, each in [−1, 1].
    ///
    /// # Errors
    /// [`FileError`] when they cannot be written, and after the 24 hours that a file can hold.
    pub fn add(&mut self, ears: &[[f32; 2]]) -> Result<(), FileError> {
        let refused = |reason| FileError::writing(&self.path, reason);
        let most = (u32::MAX - HEAD as u32) / BYTES_PER_MOMENT;
        let added = u32::try_from(ears.len()).unwrap_or(u32::MAX);
        if added > most - self.moments {
            return Err(refused(io::ErrorKind::FileTooLarge.into()));
        }
        self.moments += added;
        for sample in ears.iter().flatten() {
            let whole = (sample.clamp(-1.0, 1.0) * f32::from(i16::MAX)).round() as i16;
            self.file.write_all(&whole.to_le_bytes()).map_err(refused)?;
        }
        Ok(())
    }

    /// Writes the head, and gives the file its name.
    ///
    /// # Errors
    /// [`FileError`] when the disk is full.
    pub fn finish(self) -> Result<(), FileError> {
        let Self {
            path,
            file,
            moments,
        } = self;
        let written = || -> io::Result<()> {
            let mut file = file.into_inner().map_err(io::IntoInnerError::into_error)?;
            file.seek(SeekFrom::Start(0))?;
            file.write_all(&head(moments))?;
            file.commit()
        };
        written().map_err(|reason| FileError::writing(&path, reason))
    }
}

fn head(moments: u32) -> [u8; HEAD] {
    let data = moments * BYTES_PER_MOMENT;
    let mut head = [0; HEAD];
    let mut at = 0;
    let mut put = |bytes: &[u8]| {
        head[at..at + bytes.len()].copy_from_slice(bytes);
        at += bytes.len();
    };
    put(b"RIFF");
    put(&(data + HEAD as u32 - 8).to_le_bytes());
    put(b"WAVEfmt ");
    put(&16_u32.to_le_bytes());
    // Whole numbers without compression.
    put(&1_u16.to_le_bytes());
    put(&CHANNELS.to_le_bytes());
    put(&RATE_HZ.to_le_bytes());
    put(&(RATE_HZ * BYTES_PER_MOMENT).to_le_bytes());
    put(&(CHANNELS * BYTES_PER_SAMPLE).to_le_bytes());
    put(&(8 * BYTES_PER_SAMPLE).to_le_bytes());
    put(b"data");
    put(&data.to_le_bytes());
    head
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn the_file_is_what_the_format_says() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("sound.wav");
        let mut wav = WavFile::create(&path).expect("it can be written");
        wav.add(&[[0.0, 1.0], [-2.0, 0.5]]).expect("there is room");
        assert!(!path.exists(), "only complete files appear");
        wav.finish().expect("there is room");
        let bytes = fs::read(&path).expect("it exists");
        assert_eq!(&bytes[..4], b"RIFF");
        assert_eq!(&bytes[8..16], b"WAVEfmt ");
        let number = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four"));
        assert_eq!((number(4), number(40)), (bytes.len() as u32 - 8, 8));
        assert_eq!((number(24), number(28)), (48_000, 192_000));
        let samples: Vec<i16> = bytes[44..]
            .chunks(2)
            .map(|pair| i16::from_le_bytes(pair.try_into().expect("two")))
            .collect();
        assert_eq!(samples, [0, 32767, -32767, 16384]);
    }

    #[test]
    fn a_file_that_cannot_be_written_is_told() {
        let nowhere = Path::new("/nonexistent/sound.wav");
        assert!(matches!(
            WavFile::create(nowhere),
            Err(FileError::NoFolder { .. })
        ));
    }
}

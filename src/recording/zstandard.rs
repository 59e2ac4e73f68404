//! Zstandard frames, RFC 8878, one behind the other, with their checksums.

use std::io::{self, Read};

use ruzstd::decoding::errors::{FrameDecoderError, ReadFrameHeaderError};
use ruzstd::decoding::{BlockDecodingStrategy, FrameDecoder};

/// A frame that is decoded as it is read.
pub(crate) struct Frame<R> {
    /// States where its bytes come from; behind the frame when all of it was read.
    pub source: R,
    decoder: FrameDecoder,
}

impl<R: Read> Frame<R> {
    /// The frame that begins here, past those without content; `None` at the end.
    ///
    /// # Errors
    /// Something else than a frame, one that is damaged, or one that looks back by more than 128
    /// MiB.
    pub(crate) fn next(mut source: R) -> io::Result<Option<Self>> {
        loop {
            let mut first = [0; 1];
            if source.read(&mut first)? == 0 {
                return Ok(None);
            }
            let mut decoder = FrameDecoder::new();
            match decoder.init(first.as_slice().chain(&mut source)) {
                Ok(()) => return Ok(Some(Self { source, decoder })),
                Err(FrameDecoderError::ReadFrameHeaderError(ReadFrameHeaderError::SkipFrame { length, .. })) => {
                    let passed = io::copy(&mut source.by_ref().take(u64::from(length)), &mut io::sink())?;
                    if passed < u64::from(length) {
                        return Err(io::ErrorKind::UnexpectedEof.into());
                    }
                }
                Err(error) => return Err(io::Error::other(format!("damaged Zstandard data: {error}"))),
            }
        }
    }

    /// Returns whether what was read is what was packed.
    fn check(&self) -> io::Result<()> {
        let [stated, found] = [self.decoder.get_checksum_from_data(), self.decoder.get_calculated_checksum()];
        if stated.is_some() && stated != found {
            return Err(io::Error::other("damaged Zstandard data: its checksum does not match"));
        }
        Ok(())
    }
}

impl<R: Read> Read for Frame<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        while self.decoder.can_collect() == 0 && !self.decoder.is_finished() {
            let one = BlockDecodingStrategy::UptoBlocks(1);
            self.decoder.decode_blocks(&mut self.source, one).map_err(io::Error::other)?;
        }
        match self.decoder.read(buffer)? {
            0 if !buffer.is_empty() => self.check().map(|()| 0),
            count => Ok(count),
        }
    }
}

/// All frames of a source.
pub(super) struct Frames<R> {
    state: State<R>,
}

enum State<R> {
    Between(Option<R>),
    Within(Box<Frame<R>>),
}

impl<R: Read> Frames<R> {
    /// From the first one on.
    pub(super) fn new(source: R) -> Self {
        Self { state: State::Between(Some(source)) }
    }
}

impl<R: Read> Read for Frames<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        loop {
            match std::mem::replace(&mut self.state, State::Between(None)) {
                State::Between(None) => return Ok(0),
                State::Between(Some(source)) => match Frame::next(source)? {
                    Some(frame) => self.state = State::Within(Box::new(frame)),
                    None => return Ok(0),
                },
                State::Within(mut frame) => {
                    let count = frame.read(buffer)?;
                    if count > 0 || buffer.is_empty() {
                        self.state = State::Within(frame);
                        return Ok(count);
                    }
                    self.state = State::Between(Some(frame.source));
                }
            }
        }
    }
}

//! Memory of a compute device: written, packed and read back.

use wgpu::util::{BufferInitDescriptor, DeviceExt};

use super::{ATTEMPT, Gpu, USE_CPU, timeout};
use crate::error::{Error, Result};
use crate::parallel;

/// A stretch of memory on the device.
#[derive(Debug, Clone)]
pub struct Buffer {
    memory: wgpu::Buffer,
    begin: u64,
    /// Its length, where it does not reach to the end of the memory.
    bytes: Option<wgpu::BufferSize>,
}

impl Buffer {
    /// All of a piece of memory.
    fn whole(memory: wgpu::Buffer) -> Self {
        Self { memory, begin: 0, bytes: None }
    }

    pub(super) fn binding(&self) -> wgpu::BindingResource<'_> {
        let (buffer, offset, size) = (&self.memory, self.begin, self.bytes);
        wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer, offset, size })
    }
}

/// One binding of a dispatch: its contents, and how many bytes the shader declares.
#[derive(Debug, Clone)]
pub struct Piece {
    /// The bytes at its beginning.
    pub contents: Vec<u8>,
    /// Length of the binding; what stands behind the contents is not read.
    pub bound: u64,
}

impl Piece {
    /// A mirror of a shader's struct.
    pub fn of<T: bytemuck::NoUninit>(mirror: &T) -> Self {
        Self { contents: bytemuck::bytes_of(mirror).to_vec(), bound: size_of::<T>() as u64 }
    }

    /// The beginning of an array that the shader declares with this many bytes.
    pub fn begin<T: bytemuck::NoUninit>(array: &[T], bound: usize) -> Self {
        let contents = bytemuck::cast_slice(array).to_vec();
        Self { bound: (bound as u64).max(contents.len() as u64), contents }
    }
}

/// Hands on the pieces of a column, by its number.
pub(super) type Column<'a> = dyn Fn(usize, &mut dyn FnMut(&[u8])) + Sync + 'a;

impl Gpu {
    /// A storage buffer with these bytes.
    ///
    /// # Errors
    /// Not enough memory.
    pub fn upload(&self, bytes: &[u8]) -> Result<Buffer> {
        self.buffer(bytes, wgpu::BufferUsages::STORAGE)
    }

    /// Writes a buffer of columns as long as each other: the pieces that `column` hands on, one after
    /// the other, and zeros behind. All threads write into the memory that the device copies from.
    ///
    /// # Errors
    /// Not enough memory; the device was lost.
    pub(super) fn write_columns(
        &self,
        buffer: &Buffer,
        column_bytes: u64,
        columns: usize,
        column: &Column<'_>,
    ) -> Result<()> {
        self.caught("write to memory", || {
            let view = |k: usize| {
                let size = wgpu::BufferSize::new(column_bytes)?;
                self.queue.write_buffer_with(&buffer.memory, buffer.begin + column_bytes * k as u64, size)
            };
            let mut views: Vec<Option<wgpu::QueueWriteBufferView>> = (0..columns).map(view).collect();
            parallel::for_each_mut(&mut views, |k, view| {
                let Some(view) = view else { return };
                let mut at = 0;
                column(k, &mut |piece| {
                    view.slice(at..at + piece.len()).copy_from_slice(piece);
                    at += piece.len();
                });
                view.slice(at..).fill(0);
            });
        })
    }

    /// Writes columns into a new storage buffer.
    ///
    /// # Errors
    /// Not enough memory.
    pub(super) fn upload_columns(&self, column_bytes: u64, columns: usize, column: &Column<'_>) -> Result<Buffer> {
        let buffer = self.zeros(column_bytes * columns as u64)?;
        self.write_columns(&buffer, column_bytes, columns, column)?;
        Ok(buffer)
    }

    /// Sends what many dispatches read, uniforms and storage alike, in one piece of memory: a buffer
    /// each would cost more than a short dispatch does.
    ///
    /// # Errors
    /// Not enough memory.
    pub fn pack(&self, pieces: &[Piece]) -> Result<Vec<Buffer>> {
        let limits = self.device.limits();
        let apart =
            u64::from(limits.min_uniform_buffer_offset_alignment.max(limits.min_storage_buffer_offset_alignment));
        let (mut bytes, mut begins) = (Vec::new(), Vec::with_capacity(pieces.len()));
        for piece in pieces {
            begins.push(bytes.len() as u64);
            bytes.extend_from_slice(&piece.contents);
            bytes.resize((bytes.len() as u64).next_multiple_of(apart) as usize, 0);
        }
        let end = begins.iter().zip(pieces).map(|(begin, piece)| begin + piece.bound.next_multiple_of(4)).max();
        bytes.resize(bytes.len().max(end.unwrap_or(4) as usize), 0);
        let memory = self.buffer(&bytes, wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::STORAGE)?.memory;
        let piece = |(begin, piece): (u64, &Piece)| {
            let bytes = wgpu::BufferSize::new(piece.bound.next_multiple_of(4));
            Buffer { memory: memory.clone(), begin, bytes }
        };
        Ok(begins.into_iter().zip(pieces).map(piece).collect())
    }

    /// A uniform buffer with these bytes.
    ///
    /// # Errors
    /// Not enough memory.
    pub fn uniform(&self, bytes: &[u8]) -> Result<Buffer> {
        self.buffer(bytes, wgpu::BufferUsages::UNIFORM)
    }

    fn buffer(&self, contents: &[u8], usage: wgpu::BufferUsages) -> Result<Buffer> {
        let usage = usage | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
        self.caught("allocate memory", || {
            Buffer::whole(self.device.create_buffer_init(&BufferInitDescriptor { label: None, contents, usage }))
        })
    }

    /// A storage buffer of zeros.
    ///
    /// # Errors
    /// Not enough memory.
    pub fn zeros(&self, bytes: u64) -> Result<Buffer> {
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
        let size = bytes.max(4).next_multiple_of(4);
        self.caught("allocate memory", || {
            Buffer::whole(self.device.create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size,
                usage,
                mapped_at_creation: false,
            }))
        })
    }

    /// Overwrites the beginning of a buffer, before what is submitted next.
    ///
    /// # Errors
    /// Not enough memory; the device was lost.
    pub fn write(&self, buffer: &Buffer, bytes: &[u8]) -> Result<()> {
        self.caught("write to memory", || self.queue.write_buffer(&buffer.memory, buffer.begin, bytes))
    }

    /// The first bytes of a buffer, after all that was submitted.
    ///
    /// # Errors
    /// The device was lost.
    pub fn read(&self, buffer: &Buffer, bytes: u64) -> Result<Vec<u8>> {
        self.guarded(|| self.read_back(buffer, bytes))
    }

    fn read_back(&self, buffer: &Buffer, bytes: u64) -> Result<Vec<u8>> {
        let staging = self.caught("read back", || {
            let staging = self.device.create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size: bytes,
                usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            let mut encoder = self.device.create_command_encoder(&Default::default());
            encoder.copy_buffer_to_buffer(&buffer.memory, buffer.begin, &staging, 0, bytes);
            self.queue.submit([encoder.finish()]);
            staging
        })?;
        let (send, receive) = std::sync::mpsc::channel();
        staging.map_async(wgpu::MapMode::Read, .., move |result| {
            // Nobody listens any more if the wait below has failed.
            let _ = send.send(result);
        });
        let failed = |cause: String| Error::new(ATTEMPT, cause, USE_CPU);
        self.poll(None)?;
        match receive.recv_timeout(timeout()) {
            Ok(Ok(())) => {}
            Ok(Err(e)) => return Err(failed(e.to_string())),
            Err(e) => return Err(failed(e.to_string())),
        }
        let view = staging.get_mapped_range(..).map_err(|e| failed(e.to_string()))?;
        Ok(view.to_vec())
    }
}

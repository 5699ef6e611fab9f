//! Loops that the host does not look at until later: how what stands behind them is left out if they were not done.
//!
//! A kernel behind each such loop reads its counter. If that is not zero, the kernel writes down which loop it was and
//! makes the sizes of all later dispatches zero: those that the host knows lie in a table here, from which everything
//! behind the first such loop is dispatched; those in buffers of others it keeps, to be put back when the loop goes on.
//! Nothing that was left out can write those buffers, so they stay zero. Fills and copies are done by kernels, which can
//! be left out like all others; what a kernel cannot do waits for a look. Reads go on: they are read again later.

use crate::Error;
use crate::buffer::{Buffer, View};
use crate::device::Device;
use crate::hazards::{Scope, Use};
use crate::kernel::Kernel;
use crate::kernels::{CopyWords, CopyWordsArgs, FillWords, FillWordsArgs, HaltUnfinished, HaltUnfinishedArgs};
use crate::recording::{ReadBack, Recording, Repeat, Step};
use crate::run::{Groups, Run, Stop, used};
use crate::shader::{Encoder, Shader, Touch};
use std::ops::Range;

/// A loop that was run ahead.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Guard {
    /// Its place in the recording.
    pub(crate) step: usize,
    pub(crate) name: &'static str,
    pub(crate) rounds: u32,
    /// Looks that found it not done.
    pub(crate) misses: u32,
}

/// Kernels, and memory: which loop halted, sizes, addresses of sizes elsewhere, and what those were.
pub(crate) struct Ahead {
    halt: Kernel<HaltUnfinished>,
    fill: Kernel<FillWords>,
    copy: Kernel<CopyWords>,
    memory: Buffer<u32>,
}

/// Where things lie in the memory, in words.
struct Layout {
    sizes: Range<usize>,
    addresses: Range<usize>,
    saved: Range<usize>,
}

/// Bytes that a command buffer takes in one piece.
const PIECE: usize = 1 << 16;

impl Layout {
    fn of(recording: &Recording) -> Self {
        let sizes = 4..4 + 4 * recording.sizes.len();
        let addresses = sizes.end..sizes.end + (2 * recording.indirect.len()).next_multiple_of(4);
        let saved = addresses.end..addresses.end + 4 * recording.indirect.len();
        Layout { sizes, addresses, saved }
    }
}

impl Recording {
    /// Whether it has loops that run ahead.
    pub(crate) fn runs_ahead(&self) -> bool {
        self.steps.iter().any(|step| matches!(step, Step::Repeat(Repeat { ahead: true, .. })))
    }
}

impl Ahead {
    pub(crate) fn new(device: &Device, recording: &Recording) -> Result<Self, Error> {
        Ok(Ahead {
            halt: Kernel::new(device, &[])?,
            fill: Kernel::new(device, &[])?,
            copy: Kernel::new(device, &[])?,
            memory: Buffer::new(device, "loops run ahead", Layout::of(recording).saved.end.next_power_of_two())?,
        })
    }

    pub(crate) fn fits(&self, recording: &Recording) -> bool {
        self.memory.len() >= Layout::of(recording).saved.end
    }

    fn touch(&self, words: Range<usize>, write: bool) -> Touch {
        let mut touch = Touch::of(self.memory.view(), write);
        touch.end = touch.start + 4 * words.end as u64;
        touch.start += 4 * words.start as u64;
        touch
    }
}

/// What is missing if the engine made no memory: a run makes it for every recording that needs it.
fn none() -> Error {
    Error::Recording { command: "repeat_ahead", why: "no memory for it was made".to_owned() }
}

fn encoded<S: Shader>(arguments: &S::Args<'_>) -> (Vec<u8>, Vec<Use>) {
    let (mut bytes, mut touches) = (Vec::new(), Vec::new());
    S::encode(arguments, &mut Encoder::new(&S::CODE, &mut bytes, &mut touches));
    (bytes, touches.iter().map(|touch| used(touch, Scope::Compute)).collect())
}

impl Run<'_, '_> {
    /// Whether the next command may have to be left out.
    pub(crate) fn runs_ahead(&self) -> bool {
        !self.guards.is_empty()
    }

    /// Where the size at a place of the recording's lies.
    pub(crate) fn size_at(&self, place: u32) -> Result<Touch, Error> {
        let ahead = self.engine.ahead.as_ref().ok_or_else(none)?;
        let first = 4 + 4 * place as usize;
        Ok(ahead.touch(first..first + 3, false))
    }

    /// Behind the rounds of a loop: what follows only runs if it is done.
    pub(crate) fn guard(&mut self, counter: &Touch, guard: Guard) -> Result<(), Stop> {
        self.make_room_to_stamp()?;
        if !self.runs_ahead() {
            self.write_table()?;
        }
        let recording = self.recording;
        let layout = Layout::of(recording);
        let ahead = self.engine.ahead.as_ref().ok_or_else(none)?;
        let kernel = ahead.halt.clone();
        let [halt, sizes, addresses, saved] =
            [0..4, layout.sizes, layout.addresses, layout.saved].map(|words| ahead.touch(words, true));
        let arguments = HaltUnfinishedArgs {
            counter: View::of_touch(counter),
            halt: View::of_touch(&halt),
            sizes: View::of_touch(&sizes),
            addresses: View::of_touch(&addresses).cast::<u64>(),
            saved: View::of_touch(&saved),
            number: self.guards.len() as u32 + 1,
            size_count: recording.sizes.len() as u32,
            address_count: recording.indirect.len() as u32,
        };
        let (bytes, mut uses) = encoded::<HaltUnfinished>(&arguments);
        uses.extend(recording.indirect.iter().map(|groups| Use { write: true, ..used(groups, Scope::Compute) }));
        self.dispatch(&kernel.inner, "halt_unfinished", &Groups::Are([1, 1, 1]), &bytes, &uses)?;
        self.guards.push(guard);
        Ok(())
    }

    /// No loop has halted, and every size is what it is.
    fn write_table(&mut self) -> Result<(), Error> {
        let (recording, layout) = (self.recording, Layout::of(self.recording));
        let mut table = vec![0_u32; layout.addresses.end];
        for (words, groups) in table[layout.sizes].chunks_exact_mut(4).zip(&recording.sizes) {
            words[..3].copy_from_slice(groups);
        }
        for (words, groups) in table[layout.addresses].chunks_exact_mut(2).zip(&recording.indirect) {
            let address = groups.buffer.address + groups.start;
            words.copy_from_slice(&[address as u32, (address >> 32) as u32]);
        }
        let all = self.engine.ahead.as_ref().ok_or_else(none)?.touch(0..table.len(), true);
        let commands = self.order(&[used(&all, Scope::Transfer)])?;
        let raw = &self.engine.submitter.device.raw;
        for (piece, at) in bytemuck::cast_slice(&table).chunks(PIECE).zip((all.start..).step_by(PIECE)) {
            // SAFETY: the command buffer is being recorded; pieces are whole words within the buffer, and no longer than
            // such a command takes.
            unsafe { raw.cmd_update_buffer(commands, all.buffer.memory.buffer, at, piece) };
        }
        Ok(())
    }

    /// Brings the number of the loop that halted along, if some were run ahead; the word's place.
    pub(crate) fn read_halt(&mut self) -> Result<Option<u32>, Error> {
        let place = self.recording.words;
        if !self.runs_ahead() {
            return Ok(None);
        }
        let halt = self.engine.ahead.as_ref().ok_or_else(none)?.touch(0..1, false);
        self.read(&halt, ReadBack { first: place, len: 1 })?;
        Ok(Some(place))
    }

    /// The sizes in buffers of others, as they were when a loop halted.
    pub(crate) fn put_back(&mut self) -> Result<(), Error> {
        let (recording, first) = (self.recording, Layout::of(self.recording).saved.start);
        for (groups, place) in recording.indirect.iter().zip((first..).step_by(4)) {
            let from = self.engine.ahead.as_ref().ok_or_else(none)?.touch(place..place + 3, false);
            let to = Use { write: true, ..used(groups, Scope::Transfer) };
            let commands = self.order(&[used(&from, Scope::Transfer), to])?;
            self.copy(commands, &from, groups.buffer.memory.buffer, groups.start);
        }
        Ok(())
    }

    /// A fill that may be left out.
    pub(crate) fn fill_ahead(&mut self, to: &Touch, value: u32, place: u32) -> Result<(), Stop> {
        let kernel = self.engine.ahead.as_ref().ok_or_else(none)?.fill.clone();
        let to = View::of_touch(to);
        self.words_ahead("fill", &kernel, &FillWordsArgs { to, value, count: to.len() as u32 }, place)
    }

    /// A copy that may be left out.
    pub(crate) fn copy_ahead(&mut self, from: &Touch, to: &Touch, place: u32) -> Result<(), Stop> {
        let kernel = self.engine.ahead.as_ref().ok_or_else(none)?.copy.clone();
        let (from, to) = (View::of_touch(from), View::of_touch(to));
        self.words_ahead("copy", &kernel, &CopyWordsArgs { from, to, count: to.len() as u32 }, place)
    }

    fn words_ahead<S: Shader>(
        &mut self,
        name: &'static str,
        kernel: &Kernel<S>,
        arguments: &S::Args<'_>,
        place: u32,
    ) -> Result<(), Stop> {
        let (bytes, mut uses) = encoded::<S>(arguments);
        let size = self.size_at(place)?;
        uses.push(used(&size, Scope::Indirect));
        self.dispatch(&kernel.inner, name, &Groups::In(size), &bytes, &uses)
    }
}

//! Recordings: what stages append their work to. Nothing here touches the device.

use crate::Error;
use crate::buffer::{BufferInner, View};
use crate::device::{Device, DeviceInner};
use crate::kernel::{Kernel, KernelInner};
use crate::shader::{Encoder, Shader, Touch};
use bytemuck::Pod;
use std::sync::Arc;

/// Workgroups of a row of dispatches along x that every device takes.
const ROW: u64 = 65535;
/// Bytes that kernels reach from the address of most arguments: shaders count offsets in 32 bits.
pub(crate) const REACH: u64 = 1 << 32;
/// Words that a workgroup of the kernels fills or copies.
const WORDS_OF_A_GROUP: u32 = 16 * 256;

/// The workgroups that `items` need where one takes `each`, folded over y. Kernels number them by `group_index()` of
/// `groups.glsl`; the last ones may lie beyond the end.
pub fn groups_for(items: usize, each: u32) -> [u32; 3] {
    let wanted = (items as u64).div_ceil(u64::from(each.max(1)));
    let rows = wanted.div_ceil(ROW);
    match rows {
        0 => [0, 0, 0],
        rows => [wanted.div_ceil(rows) as u32, u32::try_from(rows).unwrap_or(u32::MAX), 1],
    }
}

/// Where a value that the device wrote will be found in the report.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReadBack {
    pub(crate) first: u32,
    pub(crate) len: u32,
}

pub(crate) enum Step {
    Dispatch {
        kernel: Arc<KernelInner>,
        size: Size,
        arguments: Vec<u8>,
        touches: Vec<Touch>,
    },
    /// Fills and copies have a place among the sizes where a kernel can do them.
    Fill {
        to: Touch,
        value: u32,
        place: Option<u32>,
    },
    Copy {
        from: Touch,
        to: Touch,
        place: Option<u32>,
    },
    Read {
        from: Touch,
        to: ReadBack,
    },
    Section(&'static str),
    Repeat(Repeat),
}

/// Sizes known to the host have a place among all of them.
pub(crate) enum Size {
    Direct([u32; 3], u32),
    Indirect(Touch),
}

pub(crate) struct Repeat {
    pub(crate) name: &'static str,
    pub(crate) counter: Touch,
    pub(crate) read: ReadBack,
    pub(crate) bound: u32,
    /// Rounds before the first look.
    pub(crate) first: u32,
    /// Rounds before each later one.
    pub(crate) batch: u32,
    /// Whether the first look waits for those behind it.
    pub(crate) ahead: bool,
    pub(crate) body: Vec<Step>,
}

/// A list of work. Commands run as if one after the other; what does not conflict may overlap.
///
/// A command that cannot be makes the whole recording one that cannot be run: [`Engine::run`](crate::Engine::run) then
/// gives the first such error, so that stages append without asking.
pub struct Recording {
    pub(crate) device: Arc<DeviceInner>,
    pub(crate) steps: Vec<Step>,
    pub(crate) words: u32,
    pub(crate) error: Option<Error>,
    /// Workgroups of every dispatch that the host knows, and of fills and copies done by kernels.
    pub(crate) sizes: Vec<[u32; 3]>,
    /// Where other sizes lie, each once.
    pub(crate) indirect: Vec<Touch>,
    nested: bool,
}

impl std::fmt::Debug for Recording {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Recording({} commands, error {:?})", self.steps.len(), self.error)
    }
}

impl Recording {
    /// An empty one.
    pub fn new(device: &Device) -> Self {
        Recording {
            device: Arc::clone(&device.inner),
            steps: Vec::new(),
            words: 0,
            error: None,
            sizes: Vec::new(),
            indirect: Vec::new(),
            nested: false,
        }
    }

    /// What follows, up to the next section, is timed under this name: with two timestamps for all of it, where those of
    /// commands would take longer than small commands do. In a repeated body it is nothing.
    pub fn section(&mut self, name: &'static str) {
        if !self.nested {
            self.steps.push(Step::Section(name));
        }
    }

    /// Whether anything is timed as a section.
    pub(crate) fn has_sections(&self) -> bool {
        self.steps.iter().any(|step| matches!(step, Step::Section(_)))
    }

    /// Commands at this level; a repeated body counts as one.
    pub fn len(&self) -> usize {
        self.steps.len()
    }

    /// Whether there is nothing to do.
    pub fn is_empty(&self) -> bool {
        self.steps.is_empty()
    }

    /// Runs a kernel in so many workgroups; none is nothing.
    pub fn dispatch<S: Shader>(&mut self, kernel: &Kernel<S>, groups: [u32; 3], arguments: &S::Args<'_>) {
        if groups.contains(&0) {
            return;
        }
        let most = self.device.info.limits.workgroups;
        if (0..3).any(|axis| groups[axis] > most[axis]) {
            return self.fail(kernel.inner.name, format!("{groups:?} workgroups; the device has up to {most:?}"));
        }
        let place = self.place(groups);
        self.push_dispatch(kernel, Size::Direct(groups, place), arguments);
    }

    /// Runs a kernel in as many workgroups as the first three words of `groups` say when it is its turn. The kernel
    /// `dispatch_size` writes such words.
    pub fn dispatch_indirect<S: Shader>(&mut self, kernel: &Kernel<S>, groups: View<'_, u32>, arguments: &S::Args<'_>) {
        if groups.len() < 3 {
            return self.fail(kernel.inner.name, format!("{} words of workgroups; three are needed", groups.len()));
        }
        let mut touch = Touch::of(groups, false);
        touch.end = touch.start + 12;
        self.owns(kernel.inner.name, &touch.buffer);
        if !self.indirect.iter().any(|known| known.buffer.id == touch.buffer.id && known.start == touch.start) {
            self.indirect.push(touch.clone());
        }
        self.push_dispatch(kernel, Size::Indirect(touch), arguments);
    }

    fn place(&mut self, groups: [u32; 3]) -> u32 {
        self.sizes.push(groups);
        self.sizes.len() as u32 - 1
    }

    /// The place of a kernel's size that does so many bytes, if one can.
    fn place_of_words(&mut self, bytes: u64) -> Option<u32> {
        let words = bytes / 4;
        let possible = bytes.is_multiple_of(4) && bytes <= REACH;
        possible.then(|| self.place(groups_for(words as usize, WORDS_OF_A_GROUP)))
    }

    fn push_dispatch<S: Shader>(&mut self, kernel: &Kernel<S>, size: Size, arguments: &S::Args<'_>) {
        let (mut bytes, mut touches) = (Vec::new(), Vec::new());
        S::encode(arguments, &mut Encoder::new(&S::CODE, &mut bytes, &mut touches));
        let name = kernel.inner.name;
        for touch in &touches {
            self.owns(name, &touch.buffer);
            let bytes = touch.end - touch.start;
            if bytes > REACH && !touch.far {
                let buffer = touch.buffer.name;
                self.fail(name, format!("{bytes} bytes of `{buffer}`; a kernel reaches {REACH} from an address"));
            }
        }
        if !Arc::ptr_eq(&kernel.inner.device, &self.device) {
            self.fail(name, "the kernel is of another device".to_owned());
        }
        self.steps.push(Step::Dispatch { kernel: Arc::clone(&kernel.inner), size, arguments: bytes, touches });
    }

    /// Fills with a word.
    pub fn fill(&mut self, to: View<'_, u32>, value: u32) {
        if to.is_empty() {
            return;
        }
        self.owns("fill", &to.buffer.clone());
        let place = self.place_of_words(to.bytes());
        self.steps.push(Step::Fill { to: Touch::of(to, true), value, place });
    }

    /// Copies all elements to the first of `to`, which may not overlap them. By the driver's command, which can be much
    /// slower than memory: [`Copier`](crate::primitives::Copier) is for long arrays.
    pub fn copy<T: Pod>(&mut self, from: View<'_, T>, to: View<'_, T>) {
        let bytes = from.bytes();
        if bytes == 0 {
            return;
        }
        if from.len() > to.len() {
            return self.fail("copy", format!("{} elements do not fit in {}", from.len(), to.len()));
        }
        let apart = to.start + bytes <= from.start || from.start + bytes <= to.start;
        if Arc::ptr_eq(from.buffer, to.buffer) && !apart {
            return self.fail("copy", "the ranges overlap".to_owned());
        }
        self.owns("copy", from.buffer);
        self.owns("copy", to.buffer);
        let mut target = Touch::of(to, true);
        target.end = target.start + bytes;
        let place = self.place_of_words(bytes);
        self.steps.push(Step::Copy { from: Touch::of(from, false), to: target, place });
    }

    /// Brings words back with the report. Meant for counts: long arrays come by
    /// [`Engine::download`](crate::Engine::download). In a repeated body the last round's words remain.
    pub fn read(&mut self, from: View<'_, u32>) -> ReadBack {
        let to = self.room(from.len());
        self.owns("read", from.buffer);
        if !from.is_empty() {
            self.steps.push(Step::Read { from: Touch::of(from, false), to });
        }
        to
    }

    fn room(&mut self, words: usize) -> ReadBack {
        let len = u32::try_from(words).unwrap_or(u32::MAX);
        let first = self.words;
        match first.checked_add(len).filter(|end| *end <= 1 << 20) {
            Some(end) => self.words = end,
            None => self.fail("read", "more than 2^20 words: use a download".to_owned()),
        }
        ReadBack { first, len }
    }

    /// Repeats `body` until the first word of `counter` is zero after a round, at most `bound` times; then
    /// [`Error::Bound`]. The word is looked at by the host after every `batch` rounds only, so rounds past the end have
    /// to do nothing: let them dispatch indirectly, by sizes that are zero then. At least one round runs, if `bound` is
    /// not zero.
    pub fn repeat(
        &mut self,
        name: &'static str,
        counter: View<'_, u32>,
        bound: u32,
        batch: u32,
        body: impl FnOnce(&mut Recording),
    ) {
        self.loops(name, counter, bound, [batch, batch], false, body);
    }

    /// As [`Recording::repeat`], but the host does not look after the first `first` rounds: it goes on as if the loop were
    /// done, and looks at all such loops at once, at the end of the recording or at the next plain `repeat`. Where one
    /// was not done, nothing behind it has run: the device itself leaves it out. The host then runs that loop on, and what
    /// follows, in the same way: by `batch` rounds, twice as many after the next look, up to 64 times. So a good guess
    /// costs no wait, and a bad one hardly more than the plain loop. Loops behind one that was not done begin with `first`
    /// and `batch` rounds; but a loop with no `first` rounds, which most inputs do not need, is begun only if its counter is
    /// not zero.
    ///
    /// Dispatches behind such a loop take their sizes from memory, fills and copies become kernels; that is nearly free.
    /// Within a repeated body, or where the body repeats something itself, it is a plain loop whose first batch has
    /// `first` rounds.
    pub fn repeat_ahead(
        &mut self,
        name: &'static str,
        counter: View<'_, u32>,
        bound: u32,
        first: u32,
        batch: u32,
        body: impl FnOnce(&mut Recording),
    ) {
        self.loops(name, counter, bound, [first, batch], true, body);
    }

    fn loops(
        &mut self,
        name: &'static str,
        counter: View<'_, u32>,
        bound: u32,
        [first, batch]: [u32; 2],
        ahead: bool,
        body: impl FnOnce(&mut Recording),
    ) {
        if counter.is_empty() {
            return self.fail(name, "the counter is empty".to_owned());
        }
        self.owns(name, counter.buffer);
        let mut touch = Touch::of(counter, false);
        touch.end = touch.start + 4;
        let read = self.room(1);
        let mut inner = Recording {
            device: Arc::clone(&self.device),
            steps: Vec::new(),
            words: self.words,
            error: None,
            sizes: std::mem::take(&mut self.sizes),
            indirect: std::mem::take(&mut self.indirect),
            nested: true,
        };
        body(&mut inner);
        self.words = inner.words;
        self.sizes = inner.sizes;
        self.indirect = inner.indirect;
        if let Some(error) = inner.error {
            self.error.get_or_insert(error);
        }
        let body = inner.steps;
        let ahead = ahead && !self.nested && !body.iter().any(|step| matches!(step, Step::Repeat(_)));
        let (first, batch) = (if ahead { first } else { first.max(1) }, batch.max(1));
        self.steps.push(Step::Repeat(Repeat { name, counter: touch, read, bound, first, batch, ahead, body }));
    }

    fn owns(&mut self, command: &'static str, buffer: &Arc<BufferInner>) {
        if !Arc::ptr_eq(&buffer.device, &self.device) {
            self.fail(command, format!("buffer `{}` is of another device", buffer.name));
        }
    }

    pub(crate) fn fail(&mut self, command: &'static str, why: String) {
        self.error.get_or_insert(Error::Recording { command, why });
    }
}

/// Everything that steps use, to be kept while the device works on them.
pub(crate) fn held(steps: &[Step], buffers: &mut Vec<Arc<BufferInner>>, kernels: &mut Vec<Arc<KernelInner>>) {
    for step in steps {
        match step {
            Step::Dispatch { kernel, size, touches, .. } => {
                kernels.push(Arc::clone(kernel));
                buffers.extend(touches.iter().map(|touch| Arc::clone(&touch.buffer)));
                if let Size::Indirect(touch) = size {
                    buffers.push(Arc::clone(&touch.buffer));
                }
            }
            Step::Fill { to, .. } => buffers.push(Arc::clone(&to.buffer)),
            Step::Copy { from, to, .. } => buffers.extend([Arc::clone(&from.buffer), Arc::clone(&to.buffer)]),
            Step::Read { from, .. } => buffers.push(Arc::clone(&from.buffer)),
            Step::Section(_) => {}
            Step::Repeat(Repeat { counter, body, .. }) => {
                buffers.push(Arc::clone(&counter.buffer));
                held(body, buffers, kernels);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_hold_all_and_no_more_than_a_row_too_many() {
        assert_eq!(groups_for(0, 256), [0, 0, 0]);
        assert_eq!(groups_for(1, 256), [1, 1, 1]);
        assert_eq!(groups_for(257, 256), [2, 1, 1]);
        for items in [65535 * 256, 65535 * 256 + 1, 1 << 27, (1 << 30) + 1, u32::MAX as usize] {
            let [x, y, z] = groups_for(items, 256);
            let total = u64::from(x) * u64::from(y);
            let wanted = (items as u64).div_ceil(256);
            assert!(x <= 65535 && y <= 65535 && z == 1 && total >= wanted && total < wanted + u64::from(y));
        }
    }
}

//! A kernel in its three forms: the twin on the CPU, the launch on burn's stream, unchecked as in use,
//! and plain wgpu with all run-time checks on.

use super::checked::{self, Outcome};
use super::inputs::{POISON, gpu};
use bytemuck::{Pod, cast_slice, pod_collect_to_vec};
use footwork::gpu::shader::Shader;
use footwork::gpu::{Buffer, Gpu, groups};
use footwork::motion::database::RootMotion;

/// Runs a kernel in its three forms and returns what its outputs hold as [`Forms`]: of a vector, or of a
/// tuple of vectors.
///
/// `forms!(kernel, SHADER, size, params; buffers)`: `size` is the number of invocations, or `[x, y, z]`
/// workgroups. The buffers are listed once, in the order of the kernel's arguments:
///
/// - `values`: an input;
/// - `argument => values`: an input that the twin takes in another form;
/// - `mut values`: an output that holds these values before;
/// - `out len`: an output of so many elements, poisoned before.
///
/// Whoever writes beyond the end of an output fails.
macro_rules! forms {
    ($kernel:ident, $shader:ident, $size:expr, $params:expr; $($buffers:tt)+) => {{
        let mut run = $crate::support::forms::Run::new();
        forms!(@bind run [$kernel $shader ($size) ($params)] [] [] [] $($buffers)+,)
    }};
    (@bind $run:ident $kernel:tt [$($host:tt)*] [$($device:tt)*] [$($output:ident)*]
        mut $values:expr, $($rest:tt)*) => {{
        let mut output = $run.output($values.to_vec());
        forms!(
            @bind $run $kernel
            [$($host)* (output.host())] [$($device)* (output.device())] [$($output)* output]
            $($rest)*
        )
    }};
    (@bind $run:ident $kernel:tt [$($host:tt)*] [$($device:tt)*] [$($output:ident)*]
        out $len:expr, $($rest:tt)*) => {{
        let mut output = $run.output($crate::support::forms::poison($len));
        forms!(
            @bind $run $kernel
            [$($host)* (output.host())] [$($device)* (output.device())] [$($output)* output]
            $($rest)*
        )
    }};
    (@bind $run:ident $kernel:tt [$($host:tt)*] [$($device:tt)*] $outputs:tt
        $argument:expr => $values:expr, $($rest:tt)*) => {{
        let device = $run.input(&$values[..]);
        forms!(@bind $run $kernel [$($host)* ($argument)] [$($device)* (&device)] $outputs $($rest)*)
    }};
    (@bind $run:ident $kernel:tt [$($host:tt)*] [$($device:tt)*] $outputs:tt
        $values:expr, $($rest:tt)*) => {{
        let host = &$values[..];
        let device = $run.input(host);
        forms!(@bind $run $kernel [$($host)* (host)] [$($device)* (&device)] $outputs $($rest)*)
    }};
    (@bind $run:ident [$kernel:ident $shader:ident $size:tt $params:tt]
        [$($host:tt)*] [$($device:tt)*] [$($output:ident)*]) => {{
        let params = $params;
        $kernel::twin($($host,)* &params);
        $kernel::launch(&$run.gpu, $($device,)* &params);
        let checked = $run.checked(&footwork::gpu::shader::$shader, $size, &params);
        $crate::support::forms::Forms {
            launched: ($($output.launched(&$run.gpu)),*),
            checked: ($($output.checked(&checked)),*),
            twin: ($($output.twin()),*),
        }
    }};
}

/// What a kernel's outputs hold afterwards.
#[derive(Debug)]
pub struct Forms<T> {
    pub twin: T,
    pub launched: T,
    pub checked: T,
}

impl<T> Forms<T> {
    /// The outputs by other names.
    pub fn map<U>(self, named: impl Fn(T) -> U) -> Forms<U> {
        Forms {
            twin: named(self.twin),
            launched: named(self.launched),
            checked: named(self.checked),
        }
    }

    /// Both forms of the shader, by name.
    pub fn shaders(&self) -> [(&'static str, &T); 2] {
        [("launched", &self.launched), ("checked", &self.checked)]
    }

    /// All three forms, by name.
    pub fn all(&self) -> [(&'static str, &T); 3] {
        let [launched, checked] = self.shaders();
        [("twin", &self.twin), launched, checked]
    }
}

/// A device, and what is bound for the checked form.
pub struct Run {
    pub gpu: Gpu,
    bound: Vec<Vec<u8>>,
}

impl Run {
    pub fn new() -> Self {
        Run {
            gpu: gpu(),
            bound: Vec::new(),
        }
    }

    pub fn input<T: Element>(&mut self, values: &[T]) -> Buffer<T::Word> {
        self.bound.push(cast_slice(values).to_vec());
        Buffer::from_slice(&self.gpu, &words(values))
    }

    pub fn output<T: Element>(&mut self, mut values: Vec<T>) -> Output<T> {
        let len = values.len();
        values.extend(poison::<T>(GUARD));
        Output {
            binding: self.bound.len(),
            device: self.input(&values),
            host: values,
            len,
        }
    }

    pub fn checked<P: Pod>(&self, shader: &'static Shader, size: impl Size, params: &P) -> Outcome {
        checked::run(shader, size.groups(shader), &self.bound, params)
    }
}

/// Elements behind the end of an output.
const GUARD: usize = 5;

/// Elements that nobody has written.
pub fn poison<T: Element>(len: usize) -> Vec<T> {
    let words = vec![POISON; len * size_of::<T>() / size_of::<f32>()];
    pod_collect_to_vec(&words)
}

/// An output of a kernel, for each of the forms.
pub struct Output<T: Element> {
    binding: usize,
    host: Vec<T>,
    device: Buffer<T::Word>,
    len: usize,
}

impl<T: Element> Output<T> {
    pub fn host(&mut self) -> &mut [T] {
        &mut self.host
    }

    pub fn device(&self) -> &Buffer<T::Word> {
        &self.device
    }

    pub fn twin(self) -> Vec<T> {
        guarded("twin", self.host, self.len)
    }

    pub fn launched(&self, gpu: &Gpu) -> Vec<T> {
        let words = self.device.read(gpu).expect("an output");
        guarded("launched", pod_collect_to_vec(&words), self.len)
    }

    pub fn checked(&self, outcome: &Outcome) -> Vec<T> {
        guarded("checked", outcome.of(self.binding), self.len)
    }
}

/// An output without what follows it, which must be poison still.
#[track_caller]
fn guarded<T: Element>(form: &str, mut values: Vec<T>, len: usize) -> Vec<T> {
    let behind = values.split_off(len);
    let untouched = cast_slice::<T, u8>(&behind) == cast_slice::<T, u8>(&poison(GUARD));
    assert!(
        untouched,
        "{form}: written beyond the end of {len} elements"
    );
    values
}

/// An element of a buffer as twins see it; on a device it is one or more words.
pub trait Element: Pod {
    type Word: Pod;
}

impl Element for f32 {
    type Word = f32;
}

impl Element for u32 {
    type Word = u32;
}

impl Element for u8 {
    type Word = u32;
}

impl Element for RootMotion {
    type Word = f32;
}

impl<T: Element, const N: usize> Element for [T; N]
where
    [T; N]: Pod,
{
    type Word = T::Word;
}

fn words<T: Element>(values: &[T]) -> Vec<T::Word> {
    pod_collect_to_vec(values)
}

/// How much of a shader is launched.
pub trait Size {
    fn groups(self, shader: &Shader) -> [u32; 3];
}

/// Invocations.
impl Size for usize {
    fn groups(self, shader: &Shader) -> [u32; 3] {
        groups(shader, self)
    }
}

/// Workgroups.
impl Size for [u32; 3] {
    fn groups(self, _: &Shader) -> [u32; 3] {
        self
    }
}

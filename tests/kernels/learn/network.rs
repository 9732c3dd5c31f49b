//! Two dense networks and a batch, for the kernels that evaluate and differentiate them: odd widths, every
//! activation, and minibatches that fill neither blocks nor splits.
//! Bar: a few roundings of the largest result.

use crate::inputs::{Draw, close};
use crate::support::forms::Forms;
use footwork::kernels::learn::network::{BLOCK, BatchLayout, IDENTITY, RELU, TANH};

pub const OBSERVATION: usize = 17;
pub const ACTION: usize = 12;
pub const SUMS: usize = 5;
/// Numbers of a sample; what follows the observation is not looked at here.
pub const WIDTH: usize = OBSERVATION + 4;
pub const NETWORKS: usize = 2;

/// Hidden widths, their activation, and rows.
const CASES: [(&[usize], u32, usize); 6] = [
    (&[32, 32], TANH, 512),
    (&[32, 32], RELU, 1),
    (&[33, 7], RELU, 75),
    (&[5], IDENTITY, 200),
    (&[40, 3, 65], TANH, 64),
    (&[], TANH, 20),
];

pub struct Case {
    pub layout: BatchLayout,
    /// Some more than the minibatch has, before and behind it.
    pub samples: Vec<f32>,
    pub start: u32,
    pub parameters: Vec<f32>,
    pub rows: Vec<f32>,
    pub grads: Vec<f32>,
}

impl Case {
    pub fn new(hidden: &[usize], activation: u32, rows: usize) -> Case {
        let layout = layout(hidden, activation, rows);
        let mut draw = Draw::new(rows as u32);
        let mut some = |count: usize| -> Vec<f32> {
            let values = draw.normals(count).into_iter();
            values.map(|value| 0.5 * value).collect()
        };
        let numbers = layout.numbers();
        Case {
            samples: some((rows + 9) * WIDTH),
            start: 6,
            parameters: some(layout.head.parameters as usize),
            // Activations of tanh lie within one.
            rows: some(numbers).into_iter().map(f32::tanh).collect(),
            grads: some(numbers),
            layout,
        }
    }

    pub fn all() -> impl Iterator<Item = Case> {
        let case = |&(hidden, activation, rows): &(&[usize], u32, usize)| {
            Case::new(hidden, activation, rows)
        };
        CASES.iter().map(case)
    }

    pub fn count(&self) -> usize {
        self.layout.head.rows as usize
    }

    /// Rows, those that fill the last block included.
    pub fn filled(&self) -> usize {
        self.count().next_multiple_of(BLOCK)
    }
}

/// An actor and a critic of such hidden layers.
pub fn layout(hidden: &[usize], activation: u32, rows: usize) -> BatchLayout {
    let network = |outputs: usize| {
        let (mut layers, mut inputs) = (Vec::new(), OBSERVATION);
        for &width in hidden {
            layers.push((inputs, width, activation));
            inputs = width;
        }
        layers.push((inputs, outputs, IDENTITY));
        layers
    };
    let networks = [network(ACTION), network(1)];
    let parameters = networks
        .iter()
        .flatten()
        .map(|(i, o, _)| (i + 1) * o)
        .sum::<usize>();
    let layout = BatchLayout::new(&networks, parameters + ACTION, SUMS, rows);
    layout.expect("two networks")
}

/// Within some roundings of the largest.
#[track_caller]
pub fn agree(what: &str, got: &[f32], want: &[f32]) {
    let finite = want.iter().filter(|w| w.is_finite());
    let largest = finite.fold(0.0f32, |most, w| most.max(w.abs()));
    close(what, got, want, |_| 64.0 * f32::EPSILON * largest);
}

#[track_caller]
pub fn forms_agree(what: &str, forms: &Forms<Vec<f32>>) {
    for (form, got) in forms.shaders() {
        agree(&format!("{what}, {form}"), got, &forms.twin);
    }
}

/// The splits' gradients of large networks would not fit into any memory if there were always as many.
#[test]
fn partial_sums_are_bounded() {
    for hidden in [&[32, 32][..], &[1024, 512], &[2048, 2048, 2048]] {
        let layout = layout(hidden, TANH, 8192);
        let one = (layout.head.parameters as usize) + SUMS;
        assert!(
            layout.partials() <= one.max(1 << 22),
            "{}",
            layout.partials()
        );
        let rows = layout.head.splits as usize * layout.head.split_blocks as usize * BLOCK;
        assert!(rows >= 8192, "every row is in a split");
    }
    assert_eq!(layout(&[32, 32], TANH, 8192).head.splits, 64);
}

#[test]
fn five_networks_are_too_many() {
    let networks = vec![vec![(3, 2, IDENTITY)]; 5];
    assert!(BatchLayout::new(&networks[..4], 32, 0, 8).is_some());
    assert!(BatchLayout::new(&networks, 40, 0, 8).is_none());
}

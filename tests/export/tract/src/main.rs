//! Evaluates the ONNX files of a folder with tract, beside what is recorded of each: NAME.INPUT.f32 and
//! NAME.OUTPUT.f32, rows of 32-bit floats. Fails where an output is off by more than [`LARGEST`].

use std::path::Path;
use tract_onnx::prelude::*;
use tract_onnx::tract_hir::infer::Factoid;
use tract_onnx::tract_hir::internal::DimLike;

const LARGEST: f32 = 1e-5;

fn main() -> TractResult<()> {
    let folder = std::env::args().nth(1).expect("usage: tract-check FOLDER");
    let entries = std::fs::read_dir(folder)?.map(|entry| Ok(entry?.path()));
    let mut paths: Vec<_> = entries.collect::<std::io::Result<_>>()?;
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "onnx"));
    paths.sort();
    assert!(!paths.is_empty(), "there are no ONNX files");
    paths.iter().try_for_each(|path| check(path))
}

fn check(path: &Path) -> TractResult<()> {
    let mut model = tract_onnx::onnx().model_for_path(path)?;
    let mut inputs = tvec!();
    for (at, outlet) in model.input_outlets()?.to_vec().into_iter().enumerate() {
        let values = recorded(path, &model.node(outlet.node).name)?;
        let fact = model.input_fact(at)?.clone();
        let sizes = fact
            .shape
            .dims()
            .skip(1)
            .filter_map(|size| size.concretize());
        let sizes: Vec<usize> = sizes
            .map(|size| size.to_usize())
            .collect::<Result<_, _>>()?;
        let rows = values.len() / sizes.iter().product::<usize>();
        let shape = [&[rows], &sizes[..]].concat();
        model.set_input_fact(at, f32::fact(&shape).into())?;
        inputs.push(Tensor::from_shape(&shape, &values)?.into());
    }
    let outputs = model.output_outlets()?.to_vec();
    let names: Vec<String> = outputs
        .iter()
        .map(|outlet| model.node(outlet.node).name.clone())
        .collect();
    let found = model.into_optimized()?.into_runnable()?.run(inputs)?;
    let mut worst = 0.0f32;
    for (name, output) in names.iter().zip(found.iter()) {
        let (output, wanted) = (output.to_plain_array_view::<f32>()?, recorded(path, name)?);
        assert_eq!(output.len(), wanted.len(), "{} {name}", path.display());
        let off = output.iter().zip(&wanted).map(|(a, b)| (a - b).abs());
        worst = off.fold(worst, f32::max);
    }
    println!("{}: off by {worst:.1e}", path.display());
    assert!(worst <= LARGEST, "{} is off by {worst}", path.display());
    Ok(())
}

fn recorded(path: &Path, port: &str) -> TractResult<Vec<f32>> {
    let bytes = std::fs::read(path.with_extension(format!("{port}.f32")))?;
    let words = bytes.as_chunks().0.iter();
    Ok(words.map(|word| f32::from_le_bytes(*word)).collect())
}

//! Geometry of the sphere on which latents are: vectors of length 1.

/// What is shorter than this, of vectors of length 1, has no direction.
const NO_DIRECTION: f32 = 1e-3;

/// Scalar product.
pub fn dot(a: &[f32], b: &[f32]) -> f32 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// `a` times one vector and `b` times another.
pub fn combined([a, b]: [f32; 2], [one, other]: [&[f32]; 2]) -> Vec<f32> {
    let pairs = one.iter().zip(other);
    pairs.map(|(one, other)| a * one + b * other).collect()
}

/// What a vector has across all of some orthonormal axes.
fn rest(vector: &[f32], axes: &[&[f32]]) -> Vec<f32> {
    let less = |rest: Vec<f32>, axis: &&[f32]| combined([1.0, -dot(&rest, axis)], [&rest, axis]);
    axes.iter().fold(vector.to_vec(), less)
}

/// The direction of what a vector has across all of some orthonormal axes; `None` if that is nothing.
pub fn across(vector: &[f32], axes: &[&[f32]]) -> Option<Vec<f32>> {
    let mut rest = rest(vector, axes);
    let length = dot(&rest, &rest).sqrt();
    rest.iter_mut().for_each(|number| *number /= length);
    (length > NO_DIRECTION).then_some(rest)
}

/// Some direction across all axes; `None` if they leave none.
pub fn any_across(dim: usize, axes: &[&[f32]]) -> Option<Vec<f32>> {
    (0..dim).find_map(|at| {
        let mut unit = vec![0.0; dim];
        unit[at] = 1.0;
        across(&unit, axes)
    })
}

/// A point between two of the sphere, on the great circle through them: `part` 0 is the one, 1 the other.
pub fn great_circle(from: &[f32], to: &[f32], part: f32) -> Vec<f32> {
    let angle = part * dot(from, to).clamp(-1.0, 1.0).acos();
    // From a point to itself or to the opposite one, any way is as short.
    let aside = across(to, &[from]).or_else(|| any_across(from.len(), &[from]));
    let aside = aside.unwrap_or_else(|| from.to_vec());
    combined([angle.cos(), angle.sin()], [from, &aside])
}

/// The two axes along which vectors differ most from their mean, orthonormal; any ones where they do not differ.
/// There must be at least one vector, of two numbers or more.
pub fn principal_axes(vectors: &[Vec<f32>]) -> [Vec<f32>; 2] {
    let dim = vectors[0].len();
    let mean = |at: usize| vectors.iter().map(|v| v[at]).sum::<f32>() / vectors.len() as f32;
    let mean: Vec<f32> = (0..dim).map(mean).collect();
    let away = vectors.iter().map(|v| combined([1.0, -1.0], [v, &mean]));
    let away: Vec<Vec<f32>> = away.collect();
    let first = principal_axis(&away, &[]);
    let second = principal_axis(&away, &[&first]);
    [first, second]
}

/// The axis across others along which vectors are longest: by iterated products with their second moments.
fn principal_axis(vectors: &[Vec<f32>], others: &[&[f32]]) -> Vec<f32> {
    const ITERATIONS: usize = 200;
    let rests: Vec<Vec<f32>> = vectors.iter().map(|v| rest(v, others)).collect();
    let dim = rests[0].len();
    let longest = rests.iter().max_by(|a, b| dot(a, a).total_cmp(&dot(b, b)));
    let start = longest.and_then(|longest| across(longest, others));
    let start = start.or_else(|| any_across(dim, others));
    let moved = |axis: Vec<f32>, _| {
        let sum = |sum: Vec<f32>, v: &Vec<f32>| combined([1.0, dot(v, &axis)], [&sum, v]);
        let product = rests.iter().fold(vec![0.0; dim], sum);
        across(&product, others).unwrap_or(axis)
    };
    (0..ITERATIONS).fold(start.unwrap_or_else(|| vec![0.0; dim]), moved)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_near(a: &[f32], b: &[f32]) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-5)
    }

    #[test]
    fn great_circles_stay_on_the_sphere_and_go_from_end_to_end() {
        let ends = [[1.0, 0.0, 0.0], [0.6, 0.0, 0.8], [-1.0, 0.0, 0.0]];
        for (from, to) in ends.iter().flat_map(|a| ends.iter().map(move |b| (a, b))) {
            let at = |part: f32| great_circle(from, to, part);
            assert!(
                is_near(&at(0.0), from) && is_near(&at(1.0), to),
                "{from:?} {to:?}"
            );
            let middle = at(0.5);
            assert!((dot(&middle, &middle) - 1.0).abs() < 1e-5);
            assert!((dot(&middle, from) - dot(&middle, to)).abs() < 1e-5);
        }
    }

    #[test]
    fn axes_are_those_of_the_largest_spread() {
        let vectors: Vec<Vec<f32>> = [[3.0, 0.0], [-3.0, 0.0], [0.0, 2.0], [0.0, -2.0]]
            .iter()
            .map(|[a, b]| vec![5.0 + 0.6 * a, *b, 0.8 * a])
            .collect();
        let [first, second] = principal_axes(&vectors);
        assert!(
            (dot(&first, &[0.6, 0.0, 0.8]).abs() - 1.0).abs() < 1e-5,
            "{first:?}"
        );
        assert!((second[1].abs() - 1.0).abs() < 1e-5, "{second:?}");
        // Alike, or all along a line: they are orthonormal all the same.
        for vectors in [vec![vec![1.0, 0.0, 0.0]], vectors[..2].to_vec()] {
            let [first, second] = principal_axes(&vectors);
            assert!(dot(&first, &second).abs() < 1e-5);
            assert!((dot(&second, &second) - 1.0).abs() < 1e-5);
        }
    }
}

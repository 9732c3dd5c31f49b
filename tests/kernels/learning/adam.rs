//! `adam`.

use super::*;
use footwork::gpu::kernel::groups;
use footwork::kernels::learn::adam;
use footwork::kernels::learn::network::GROUP;

/// Three steps, with a norm that is cut, one that is not, and none.
#[test]
fn adam_agrees() {
    for (case, max_norm) in Case::all().zip([0.5, 1e9, 0.0].into_iter().cycle()) {
        let parameters = case.plan.head.parameters as usize;
        let mut draw = Draw::new(4);
        let mut some = || draw.normals(parameters);
        let (gradient, first) = (some(), some());
        let second: Vec<f32> = some().into_iter().map(|value| value * value).collect();
        let mut squares = vec![0.0; (parameters + SUMS).div_ceil(GROUP)];
        for (i, slope) in gradient.iter().enumerate() {
            squares[i / GROUP] += slope * slope;
        }
        let place = case.plan.turned();
        let params = adam::Params {
            parameters: parameters as u32,
            rate: 0.01,
            unbias: 2.0,
            max_norm,
        };
        let poison = vec![POISON; parameters];
        let mut twin = [
            case.parameters.clone(),
            poison.clone(),
            first.clone(),
            second.clone(),
        ];
        {
            let [parameters, turned, first, second] = &mut twin;
            adam::twin(
                &case.plan, &gradient, &squares, &place, parameters, turned, first, second, &params,
            );
        }
        let launched = [&case.parameters, &poison, &first, &second].map(|values| up(values));
        adam::launch(
            &gpu(),
            &up(&case.table),
            &up(&gradient),
            &up(&squares),
            &up(&place),
            &launched[0],
            &launched[1],
            &launched[2],
            &launched[3],
            &params,
        );
        let buffers: [&[u8]; 8] = [
            cast_slice(&case.table),
            cast_slice(&gradient),
            cast_slice(&squares),
            cast_slice(&place),
            cast_slice(&case.parameters),
            cast_slice(&poison),
            cast_slice(&first),
            cast_slice(&second),
        ];
        let groups = groups(&shader::ADAM, parameters);
        let outcome = checked::run(&shader::ADAM, groups, &buffers, &params);
        for (i, want) in twin.iter().enumerate() {
            near("launch", &down(&launched[i]), want);
            near("checked", &outcome.of::<f32>(4 + i), want);
        }
        assert_ne!(twin[0], case.parameters);
    }
}

//! `total`.

use super::*;
use footwork::gpu::kernel::groups;
use footwork::kernels::learn::network::GROUP;
use footwork::kernels::learn::reduce_grads;

#[test]
fn total_agrees() {
    for (case, begin) in Case::all().zip([0, 1].into_iter().cycle()) {
        let parameters = case.plan.head.parameters as usize;
        let numbers = parameters + SUMS;
        let params = reduce_grads::Params {
            parameters: parameters as u32,
            begin,
        };
        let partials = Draw::new(3).normals(case.plan.head.pieces as usize * numbers);
        let poison = vec![POISON; parameters];
        let squares = vec![POISON; numbers.div_ceil(GROUP)];
        let losses = vec![0.5; SUMS];
        let mut twin = (poison.clone(), squares.clone(), losses.clone());
        reduce_grads::twin(
            &case.plan,
            &partials,
            &mut twin.0,
            &mut twin.1,
            &mut twin.2,
            &params,
        );
        let launched = (up(&poison), up(&squares), up(&losses));
        reduce_grads::launch(
            &gpu(),
            &up(&case.table),
            &up(&partials),
            &launched.0,
            &launched.1,
            &launched.2,
            &params,
        );
        let buffers: [&[u8]; 5] = [
            cast_slice(&case.table),
            cast_slice(&partials),
            cast_slice(&poison),
            cast_slice(&squares),
            cast_slice(&losses),
        ];
        let groups = groups(&shader::REDUCE_GRADS, numbers);
        let outcome = checked::run(&shader::REDUCE_GRADS, groups, &buffers, &params);
        let launched = (down(&launched.0), down(&launched.1), down(&launched.2));
        for (got, want) in [
            (&launched.0, &twin.0),
            (&launched.1, &twin.1),
            (&launched.2, &twin.2),
            (&outcome.of(2), &twin.0),
            (&outcome.of(3), &twin.1),
            (&outcome.of(4), &twin.2),
        ] {
            near("sums", got, want);
        }
    }
}

// Spheres and capsules with each other, the twin of src/physics/collision/capsule.rs.

const SIDE_BY_SIDE = 1e-8; // squared sine of the angle
const MEETING = 0.1;       // m per unit of the angle's sine

fn half_length(round: WorldGeom) -> f32 { return select(0.0, round.size.y, round.kind == CAPSULE); }

fn capsule_capsule(first: WorldGeom, second: WorldGeom) {
    let a = first.rotation[2];
    let b = second.rotation[2];
    let half = half_length(first);
    let other_half = half_length(second);
    let sideways = cross(a, b);
    let sine2 = dot(sideways, sideways);
    let crossed = sine2 >= SIDE_BY_SIDE;
    let parallel = !crossed && half > 0.0 && other_half > 0.0;
    let between = second.position - first.position;
    // Parallel: a touch at either end of the stretch that they have in common.
    for (var number = 0u; number < select(1u, 2u, parallel); number++) {
        var other = sign_of(dot(a, b)) * other_half * (2.0 * f32(number) - 1.0);
        if (!parallel) {
            // By cross products: determinants of dot products lose their digits.
            var meeting = 0.0;
            if (crossed) { meeting = dot(cross(between, b), sideways) / sine2; }
            let start = clamp(meeting, -half, half);
            other = clamp(dot(a * start - between, b), -other_half, other_half);
        }
        let opposite = dot(b * other + between, a);
        let one = clamp(opposite, -half, half);
        if (parallel && one != opposite) { other = clamp(dot(a * one - between, b), -other_half, other_half); }
        let apart = between + b * other - a * one;
        let gap2 = dot(apart, apart);
        let distance = sqrt(gap2) - first.size.x - second.size.x;
        // Where axes all but meet, the way from one to the other has no digits left.
        let inner = crossed && abs(one) < half && abs(other) < other_half;
        let meets = inner && gap2 < MEETING * MEETING * sine2;
        let direction = select(apart, sideways * sign_of(dot(between, sideways)), meets);
        let long = length(direction);
        let normal = select(vec3f(1.0, 0.0, 0.0), direction / long, long > 0.0);
        let position = first.position + a * one + normal * (first.size.x + 0.5 * distance);
        add_contact(number, position, normal, any_across(normal), distance);
    }
}

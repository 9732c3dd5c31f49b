// A world's contacts, the twin of src/physics/collision.rs. The importing shader binds `contacts`, `contact_ids` and
// `params` with `envs` and `max_contacts`.

const CONTACT_DIM = 10u; // position, normal, tangent, distance
const MAX_POINTS = 8u;   // points of a pair
const NO_SLOT = 0xffffffffu;

const PLANE = 0u;
const SPHERE = 1u;
const CAPSULE = 2u;
const BOX = 3u;

// A geom in the world.
struct WorldGeom {
    kind: u32,
    size: vec3f, // radius and half length, or half sizes
    position: vec3f,
    rotation: mat3x3f,
}

var<private> env: u32;
var<private> pair: u32;
var<private> kept: u32;
var<private> overflow: u32;

fn sign_of(value: f32) -> f32 { return select(1.0, -1.0, value < 0.0); }

// The part of a vector across a normal, as a unit vector.
fn across(normal: vec3f, vector: vec3f) -> vec3f {
    let part = vector - normal * dot(normal, vector);
    let long = length(part);
    return select(vec3f(1.0, 0.0, 0.0), part / long, long > 0.0);
}

fn any_across(normal: vec3f) -> vec3f {
    return across(normal, select(vec3f(0.0, 0.0, 1.0), vec3f(0.0, 1.0, 0.0), abs(normal.y) < 0.5));
}

fn write_vector(slot: u32, field: u32, value: vec3f) {
    let at = (slot * CONTACT_DIM + field) * params.envs + env;
    contacts[at] = value.x;
    contacts[at + params.envs] = value.y;
    contacts[at + 2u * params.envs] = value.z;
}

// A place for a contact: a free one or else that of the shallowest, if that is shallower than it.
fn slot_for(distance: f32) -> u32 {
    if (kept < params.max_contacts) {
        kept++;
        return kept - 1u;
    }
    overflow++;
    var shallowest = NO_SLOT;
    var most = distance;
    for (var slot = 0u; slot < kept; slot++) {
        let other = contacts[(slot * CONTACT_DIM + 9u) * params.envs + env];
        if (other > most) {
            most = other;
            shallowest = slot;
        }
    }
    return shallowest;
}

// Its number, less than MAX_POINTS, tells it from the others of the pair, from step to step.
fn add_contact(number: u32, position: vec3f, normal: vec3f, tangent: vec3f, distance: f32) {
    if (distance >= 0.0) { return; }
    let slot = slot_for(distance);
    if (slot == NO_SLOT) { return; }
    write_vector(slot, 0u, position);
    write_vector(slot, 3u, normal);
    write_vector(slot, 6u, tangent);
    contacts[(slot * CONTACT_DIM + 9u) * params.envs + env] = distance;
    contact_ids[slot * params.envs + env] = pair * MAX_POINTS + number;
}

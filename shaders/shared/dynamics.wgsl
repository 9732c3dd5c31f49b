// Sections of `dynamics`, in numbers of an environment: axes [dofs * 6], then these.

fn FACTORS_AT() -> u32 { return 6u * tables[DOF_COUNT]; }
fn WEIGHTED_AT() -> u32 { return FACTORS_AT() + tables[PACKED]; }
fn VELOCITIES_AT() -> u32 { return WEIGHTED_AT() + tables[DOF_COUNT]; }

// Sections of `dynamics`, in numbers of an environment: axes [dofs * 6], then these.

fn MATRIX_AT() -> u32 { return 6u * tables[DOF_COUNT]; }
fn FACTORS_AT() -> u32 { return MATRIX_AT() + tables[PACKED]; }
fn SMOOTH_AT() -> u32 { return FACTORS_AT() + tables[PACKED]; }
fn VELOCITIES_AT() -> u32 { return SMOOTH_AT() + tables[DOF_COUNT]; }

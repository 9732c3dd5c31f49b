// Sections of `dynamics`, in numbers of an environment: axes [dofs * 6], then these.

fn FACTORS_AT() -> u32 { return 6u * model_table[DOF_COUNT]; }
fn QACC_WHITENED_AT() -> u32 { return FACTORS_AT() + model_table[NM]; }
fn VELOCITIES_AT() -> u32 { return QACC_WHITENED_AT() + model_table[DOF_COUNT]; }

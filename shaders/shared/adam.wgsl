const NORM_PARTIALS = 64u;  // parts that the square of a gradient's norm is summed in

// Puts a job on the ports of bench_top.sv.
#pragma once
#include "Vbench_top.h"
#include "tb/rtl/golden.h"

namespace fovea::rtl {

inline void set_job(Vbench_top& d, const Job& job) {
  d.ag_mode_i = static_cast<unsigned>(job.mode);
  d.ag_bilinear_i = job.bilinear;
  d.ag_pairs_i = job.pairs;
  d.ag_rows_i = job.rows;
  d.ag_src_base_i = job.src_base;
  d.ag_src_pitch_i = job.src_pitch;
  d.ag_src_width_i = job.src_width;
  d.ag_src_height_i = job.src_height;
  d.ag_dst_base_i = job.dst_base;
  d.ag_dst_pitch_i = job.dst_pitch;
  d.ag_grid_log2_i = job.grid_log2;
  d.ag_pieces_i = job.pieces;
  d.ag_piece_log2_i = job.piece_log2;
  d.ag_radius_limit_i = job.radius_limit;
  d.ag_centre_x_i = static_cast<std::uint32_t>(job.centre_x);
  d.ag_centre_y_i = static_cast<std::uint32_t>(job.centre_y);
  d.ag_a0_i = static_cast<std::uint32_t>(job.a[0]);
  d.ag_a1_i = static_cast<std::uint32_t>(job.a[1]);
  d.ag_a2_i = static_cast<std::uint32_t>(job.a[2]);
  d.ag_b0_i = static_cast<std::uint32_t>(job.b[0]);
  d.ag_b1_i = static_cast<std::uint32_t>(job.b[1]);
  d.ag_b2_i = static_cast<std::uint32_t>(job.b[2]);
  d.ag_c0_i = static_cast<std::uint32_t>(job.c[0]);
  d.ag_c1_i = static_cast<std::uint32_t>(job.c[1]);
  d.ag_c2_i = static_cast<std::uint32_t>(job.c[2]);
}

}  // namespace fovea::rtl

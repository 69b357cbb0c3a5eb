  // The address generator accepts no other job, and keeps it.
  always_comb begin
    assume (job_i.pairs >= 12'd1 && job_i.pairs <= 12'd2048);
    assume (job_i.rows >= 13'd1 && job_i.rows <= 13'd4096);
  end
  always_ff @(posedge clk_i)
    if (f_past) assume ($stable(job_i));

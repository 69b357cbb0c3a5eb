// Types and widths of the remap engine. README.md, section "Address generator", defines every field.
package remap_pkg;
  localparam int unsigned FormBits = 36;      // of a linear form, Q16
  localparam int unsigned PosBits = 30;       // of a source position, Q16
  localparam int unsigned PairBits = 11;      // of a pair's number within its row
  localparam int unsigned RowBits = 12;       // of a row's number
  localparam int unsigned NodeBits = 8;       // of a grid node's number within its row
  localparam int unsigned PieceBits = 7;      // of a piece's number
  localparam int unsigned MaxNodes = 256;
  localparam int unsigned MaxPieces = 128;
  localparam int unsigned BeatBits = 82;      // of beat_t

  typedef enum logic [1:0] {
    ModeTable = 2'd0,
    ModeGrid = 2'd1,
    ModeRadial = 2'd2,
    ModeProject = 2'd3
  } mode_e;

  typedef struct packed {
    mode_e       mode;
    logic        bilinear;
    logic [11:0] pairs;        // of an output row, 1 to 2048
    logic [12:0] rows;         // 1 to 4096
    logic [29:0] src_base;     // words
    logic [12:0] src_pitch;    // words
    logic [12:0] src_width;    // pixels, even, 2 to 4096
    logic [12:0] src_height;   // rows, 1 to 4096
    logic [29:0] dst_base;     // words
    logic [12:0] dst_pitch;    // words
    logic [2:0]  grid_log2;    // of the grid's step in pixels, 2 to 6
    logic [7:0]  pieces;       // of the radial function, 1 to 128
    logic [4:0]  piece_log2;   // of a piece's width in square pixels, 0 to 23
    logic [31:0] radius_limit; // largest visible square radius, Q8
    logic [31:0] centre_x;     // of the radial function, pixels of the source, Q16
    logic [31:0] centre_y;
    logic [31:0] a0;           // linear forms: first value, step of a pair, step of a row
    logic [31:0] a1;
    logic [31:0] a2;
    logic [31:0] b0;
    logic [31:0] b1;
    logic [31:0] b2;
    logic [31:0] c0;
    logic [31:0] c1;
    logic [31:0] c2;
  } job_t;

  // What the address generator hands over for a pair of output pixels.
  typedef struct packed {
    logic        last;         // of the job
    logic        border;       // no source: the border's colour
    logic        bad;          // a table's entry that is no aligned offset within the frame
    logic        edge_x;       // the source word is the last of its row
    logic        edge_y;       // the source row is the last of the frame
    logic        odd;          // the position is in the word's second pixel
    logic [7:0]  frac_x;       // of a pixel, Q8
    logic [7:0]  frac_y;
    logic [29:0] src;          // word address
    logic [29:0] dst;          // word address
  } beat_t;
endpackage

// The structs of atlas.h as they lie in memory. A test compares them with the header.

const bytes = { pointer: 4, size: 4, i32: 4, u32: 4, f32: 4, f64: 8, u64: 8 };

// members: "type name name ...; type name ..."
function struct(members) {
  const offsets = {};
  let end = 0;
  for (const line of members.split(";")) {
    const [type, ...names] = line.trim().split(/\s+/);
    for (const name of names) {
      end = Math.ceil(end / bytes[type]) * bytes[type];
      offsets[name] = { type, offset: end };
      end += bytes[type];
    }
  }
  const largest = Math.max(...Object.values(offsets).map(({ type }) => bytes[type]));
  return { members: offsets, bytes: Math.ceil(end / largest) * largest };
}

export const structs = {
  mesh: struct(`size size; pointer positions; size position_count position_stride; pointer indices;
    size index_count index_bytes; pointer normals; size normal_stride; pointer texcoords;
    size texcoord_count texcoord_stride; pointer texcoord_indices materials seams triangle_density; f32 density;
    pointer polygon_sizes; size polygon_count; pointer seam_weights`),
  unwrap_options: struct(`size size; f64 max_stretch cone_degrees crease_degrees min_fill uv_aspect texels_per_unit;
    u32 pages; i32 page_size padding mip_levels alignment charts packing split_at_materials keep_uvs allow_rotation
    square part_gaps; pointer like; f64 seam_weight`),
  earlier_uvs: struct(`size size; pointer positions; size position_count position_stride; pointer indices;
    size index_count index_bytes; pointer uvs; size uv_count uv_stride; pointer uv_indices triangle_page pages;
    size page_count; f64 tolerance; pointer objects`),
  atlas_info: struct(`size size mesh_count chart_count page_count; pointer pages; f64 texels_per_unit utilization
    stretch_l2 stretch_999 stretch_max conformal_mean seam_length surface_area; u64 flipped_triangles thin_triangles
    texels_drawn_twice kept_charts reflattened_charts`),
  mesh_uvs: struct(`size size vertex_count triangle_count; pointer vertices uvs indices triangle_page triangle_chart`),
  polygon_uvs: struct(`size size polygon_count corner_count; pointer corners triangle_polygon; size cut_count;
    pointer cut_polygons`),
  instances: struct("size size instance_count; pointer instances"),
  charts: struct(`size size chart_count; pointer mesh page material triangle_count kept area stretch_l2 stretch_999
    stretch_max origins`),
  transfer_options: struct("size size; u32 page; i32 shifts"),
  pack_options: struct(`size size; i32 page_width page_height; u32 max_pages; i32 allow_rotation padding border
    alignment crop power_of_two square preset; f64 time_budget; u64 effort seed`),
  packed_info: struct(`size size placement_count page_count unplaced_count; pointer placements pages; f64 utilization;
    u32 page_lower_bound`),
  islands: struct(`size size; pointer uvs; size uv_count uv_stride; pointer indices; size index_count index_bytes`),
  island_options: struct(`size size; f64 texels_per_uv; u32 pages; i32 page_size padding alignment allow_rotation square
    preset`),
  packed_islands_info: struct(`size size uv_count triangle_count island_count page_count; pointer uvs triangle_island
    island_page island_angle island_offset pages; f64 texels_per_uv utilization`),
};

// Whether a member holds 0 or 1, or an effort; else it is a number.
export const flags = new Set(
  `split_at_materials keep_uvs allow_rotation square part_gaps crop power_of_two`.split(" "));
export const presets = ["fast", "standard", "best"];
export const presetMembers = new Set(["charts", "packing", "preset"]);

export const camelCase = (name) => name.replace(/_([a-z0-9])/g, (_, letter) => letter.toUpperCase());

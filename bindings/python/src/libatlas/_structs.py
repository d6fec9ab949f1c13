"""The structs of libatlas/c/atlas.h. A test compares them with the header."""

from __future__ import annotations

import ctypes
from ctypes import c_double, c_float, c_int32, c_size_t, c_uint32, c_uint64, c_void_p

import numpy as np


class Extent(ctypes.Structure):
    _fields_ = [("width", c_int32), ("height", c_int32)]


class Mesh(ctypes.Structure):
    _fields_ = [
        ("size", c_size_t),
        ("positions", c_void_p),
        ("position_count", c_size_t),
        ("position_stride", c_size_t),
        ("indices", c_void_p),
        ("index_count", c_size_t),
        ("index_bytes", c_size_t),
        ("normals", c_void_p),
        ("normal_stride", c_size_t),
        ("texcoords", c_void_p),
        ("texcoord_count", c_size_t),
        ("texcoord_stride", c_size_t),
        ("texcoord_indices", c_void_p),
        ("materials", c_void_p),
        ("seams", c_void_p),
        ("triangle_density", c_void_p),
        ("density", c_float),
        ("polygon_sizes", c_void_p),
        ("polygon_count", c_size_t),
        ("seam_weights", c_void_p),
    ]


class EarlierUvs(ctypes.Structure):
    _fields_ = [
        ("size", c_size_t),
        ("positions", c_void_p),
        ("position_count", c_size_t),
        ("position_stride", c_size_t),
        ("indices", c_void_p),
        ("index_count", c_size_t),
        ("index_bytes", c_size_t),
        ("uvs", c_void_p),
        ("uv_count", c_size_t),
        ("uv_stride", c_size_t),
        ("uv_indices", c_void_p),
        ("triangle_page", c_void_p),
        ("pages", c_void_p),
        ("page_count", c_size_t),
        ("tolerance", c_double),
        ("objects", c_void_p),
    ]


class UnwrapOptions(ctypes.Structure):
    _fields_ = [
        ("size", c_size_t),
        ("max_stretch", c_double),
        ("cone_degrees", c_double),
        ("crease_degrees", c_double),
        ("min_fill", c_double),
        ("uv_aspect", c_double),
        ("texels_per_unit", c_double),
        ("pages", c_uint32),
        ("page_size", c_int32),
        ("padding", c_int32),
        ("mip_levels", c_int32),
        ("alignment", c_int32),
        ("charts", c_int32),
        ("packing", c_int32),
        ("split_at_materials", c_int32),
        ("keep_uvs", c_int32),
        ("allow_rotation", c_int32),
        ("square", c_int32),
        ("part_gaps", c_int32),
        ("like", c_void_p),
        ("seam_weight", c_double),
    ]


class AtlasInfo(ctypes.Structure):
    _fields_ = [
        ("size", c_size_t),
        ("mesh_count", c_size_t),
        ("chart_count", c_size_t),
        ("page_count", c_size_t),
        ("pages", c_void_p),
        ("texels_per_unit", c_double),
        ("utilization", c_double),
        ("stretch_l2", c_double),
        ("stretch_999", c_double),
        ("stretch_max", c_double),
        ("conformal_mean", c_double),
        ("seam_length", c_double),
        ("surface_area", c_double),
        ("flipped_triangles", c_uint64),
        ("thin_triangles", c_uint64),
        ("texels_drawn_twice", c_uint64),
        ("kept_charts", c_uint64),
        ("reflattened_charts", c_uint64),
    ]


class MeshUvs(ctypes.Structure):
    _fields_ = [
        ("size", c_size_t),
        ("vertex_count", c_size_t),
        ("triangle_count", c_size_t),
        ("vertices", c_void_p),
        ("uvs", c_void_p),
        ("indices", c_void_p),
        ("triangle_page", c_void_p),
        ("triangle_chart", c_void_p),
    ]


class Instance(ctypes.Structure):
    _fields_ = [("page", c_uint32), ("scale", c_float * 2), ("offset", c_float * 2)]


class Instances(ctypes.Structure):
    _fields_ = [("size", c_size_t), ("instance_count", c_size_t), ("instances", c_void_p)]


class PolygonUvs(ctypes.Structure):
    _fields_ = [
        ("size", c_size_t),
        ("polygon_count", c_size_t),
        ("corner_count", c_size_t),
        ("corners", c_void_p),
        ("triangle_polygon", c_void_p),
        ("cut_count", c_size_t),
        ("cut_polygons", c_void_p),
    ]


class Charts(ctypes.Structure):
    _fields_ = [
        ("size", c_size_t),
        ("chart_count", c_size_t),
        ("mesh", c_void_p),
        ("page", c_void_p),
        ("material", c_void_p),
        ("triangle_count", c_void_p),
        ("kept", c_void_p),
        ("area", c_void_p),
        ("stretch_l2", c_void_p),
        ("stretch_999", c_void_p),
        ("stretch_max", c_void_p),
        ("origins", c_void_p),
    ]


class TransferOptions(ctypes.Structure):
    _fields_ = [("size", c_size_t), ("page", c_uint32), ("shifts", c_int32)]


class PackOptions(ctypes.Structure):
    _fields_ = [
        ("size", c_size_t),
        ("page", Extent),
        ("max_pages", c_uint32),
        ("allow_rotation", c_int32),
        ("padding", c_int32),
        ("border", c_int32),
        ("alignment", c_int32),
        ("crop", c_int32),
        ("power_of_two", c_int32),
        ("square", c_int32),
        ("preset", c_int32),
        ("time_budget", c_double),
        ("effort", c_uint64),
        ("seed", c_uint64),
    ]


class Placement(ctypes.Structure):
    _fields_ = [("page", c_uint32), ("x", c_int32), ("y", c_int32), ("rotated", c_int32)]


class PackedInfo(ctypes.Structure):
    _fields_ = [
        ("size", c_size_t),
        ("placement_count", c_size_t),
        ("page_count", c_size_t),
        ("unplaced_count", c_size_t),
        ("placements", c_void_p),
        ("pages", c_void_p),
        ("utilization", c_double),
        ("page_lower_bound", c_uint32),
    ]


class Islands(ctypes.Structure):
    _fields_ = [
        ("size", c_size_t),
        ("uvs", c_void_p),
        ("uv_count", c_size_t),
        ("uv_stride", c_size_t),
        ("indices", c_void_p),
        ("index_count", c_size_t),
        ("index_bytes", c_size_t),
    ]


class IslandOptions(ctypes.Structure):
    _fields_ = [
        ("size", c_size_t),
        ("texels_per_uv", c_double),
        ("pages", c_uint32),
        ("page_size", c_int32),
        ("padding", c_int32),
        ("alignment", c_int32),
        ("allow_rotation", c_int32),
        ("square", c_int32),
        ("preset", c_int32),
    ]


class PackedIslandsInfo(ctypes.Structure):
    _fields_ = [
        ("size", c_size_t),
        ("uv_count", c_size_t),
        ("triangle_count", c_size_t),
        ("island_count", c_size_t),
        ("page_count", c_size_t),
        ("uvs", c_void_p),
        ("triangle_island", c_void_p),
        ("island_page", c_void_p),
        ("island_angle", c_void_p),
        ("island_offset", c_void_p),
        ("pages", c_void_p),
        ("texels_per_uv", c_double),
        ("utilization", c_double),
    ]


INSTANCE = np.dtype([("page", "<u4"), ("scale", "<f4", 2), ("offset", "<f4", 2)])
PLACEMENT = np.dtype([("page", "<u4"), ("x", "<i4"), ("y", "<i4"), ("rotated", "<i4")])

#: By the names of the header.
STRUCTS: dict[str, type[ctypes.Structure]] = {
    "libatlas_extent": Extent,
    "libatlas_mesh": Mesh,
    "libatlas_earlier_uvs": EarlierUvs,
    "libatlas_unwrap_options": UnwrapOptions,
    "libatlas_atlas_info": AtlasInfo,
    "libatlas_mesh_uvs": MeshUvs,
    "libatlas_instance": Instance,
    "libatlas_instances": Instances,
    "libatlas_polygon_uvs": PolygonUvs,
    "libatlas_charts": Charts,
    "libatlas_transfer_options": TransferOptions,
    "libatlas_pack_options": PackOptions,
    "libatlas_placement": Placement,
    "libatlas_packed_info": PackedInfo,
    "libatlas_islands": Islands,
    "libatlas_island_options": IslandOptions,
    "libatlas_packed_islands_info": PackedIslandsInfo,
}

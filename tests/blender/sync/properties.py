# SPDX-License-Identifier: GPL-3.0-or-later
"""Every property of lights, materials, cameras, worlds, objects and view layers, of Blender 4.2 to 5.2.

Each is read, reported as not drawn, or irrelevant to what this engine draws, for a reason that is given.
test_properties compares these lists with Blender and with the engine.
"""

#: Properties that are read, each with another value, which must change the scene or the view.
READ: dict[str, dict[str, object]] = {
    "light": {
        "color": (1, 0, 0), "energy": 5.0, "exposure": 1.0, "normalize": False, "shape": "DISK", "size": 0.5,
        "spread": 1.0, "use_shadow": False, "use_temperature": True, "use_nodes": "toggle",
    },
    "light.cycles": {"is_portal": True},
    "tall light": {"size_y": 2.0},
    "warm light": {"temperature": 3000.0},
    "point light": {"shadow_soft_size": 0.7, "use_soft_falloff": False},
    "spot light": {"spot_size": 0.5, "spot_blend": 0.7},
    "material": {},
    "camera": {
        "clip_end": 50.0, "clip_start": 0.5, "lens": 20.0, "angle": 1.5, "angle_x": 1.5, "sensor_width": 20.0,
        "sensor_fit": "VERTICAL", "shift_x": 0.2, "shift_y": 0.2, "type": "ORTHO",
    },
    "camera fitted by height": {"angle_y": 1.5, "sensor_height": 10.0},
    "orthographic camera": {"ortho_scale": 3.0},
    "world": {},
    "world.cycles_visibility": {"camera": False},
    "object": {
        "location": (1, 2, 3), "rotation_euler": (0.1, 0.2, 0.3), "scale": (2, 2, 2), "delta_location": (1, 0, 0),
        "delta_rotation_euler": (0.1, 0, 0), "delta_scale": (2, 1, 1),
        "visible_camera": False, "visible_shadow": False,
    },
    "lamp": {"visible_diffuse": False, "visible_camera": "toggle"},
    "instancer": {"show_instancer_for_viewport": True},
    "view_layer": {"material_override": "other material", "world_override": "other world", "use_sky": False,
                   "use_solid": False},
    "layer_collection": {"exclude": True, "indirect_only": True},
    "ImageTexture": {"extension": "EXTEND", "image": None, "interpolation": "Closest", "projection": "SPHERE"},
    "ImageTexture.texture_mapping": {
        "translation": (1, 0, 0), "rotation": (1, 0, 0), "scale": (2, 1, 1), "mapping_x": "Y", "mapping_y": "X",
        "mapping_z": "X",
    },
    "UVMap": {"uv_map": "Second"},
    "MaterialOutput": {"target": "EEVEE"},
}  # fmt: skip

#: Properties that are reported as not drawn, each with a value that must add one warning.
REPORTED: dict[str, dict[str, object]] = {
    "camera.dof": {"use_dof": True},
    "world.cycles_visibility": {"diffuse": False, "glossy": False},
    "object": {"is_holdout": True, "is_shadow_catcher": True},
    "layer_collection": {"holdout": True},
    "view_layer": {"use_freestyle": True, "use_motion_blur": True},
    "UVMap": {"from_instancer": True},
}

EEVEE = "used by EEVEE only: Cycles, the reference, draws the same"
BY_BLENDER = "evaluated by Blender: the result is read"
INTERFACE = "of Blender's user interface and tools"
SAMPLING = "how Cycles samples, not what it draws"
PASSES = "passes that this engine does not register, so Blender does not offer them"
BOUNCES = "of indirect and transmitted light, which this engine does not draw"
NO_VOLUMES = "of volumes, which are reported"
UNSUPPORTED = "of features that are reported or refused by another property"
INDIRECT = "read through another of these properties, or through nodes"

#: Properties that are irrelevant, by the reason.
IRRELEVANT: dict[str, dict[str, str]] = {
    "light": {
        EEVEE: "contact_shadow_bias contact_shadow_distance contact_shadow_thickness cutoff_distance diffuse_factor "
        "shadow_buffer_bias shadow_buffer_clip_start shadow_color shadow_filter_radius shadow_jitter_overblur "
        "shadow_maximum_resolution specular_factor transmission_factor use_absolute_resolution use_contact_shadow "
        "use_custom_distance use_shadow_jitter volume_factor",
        INDIRECT: "animation_data cycles node_tree size_y temperature temperature_color type",
    },
    "light.cycles": {SAMPLING: "use_multiple_importance_sampling", BOUNCES: "max_bounces is_caustics_light"},
    "material": {
        EEVEE: "alpha_threshold blend_method max_vertex_displacement refraction_depth shadow_method "
        "show_transparent_back surface_render_method thickness_mode use_backface_culling "
        "use_backface_culling_lightprobe_volume use_backface_culling_shadow use_raytrace_refraction "
        "use_screen_refraction use_sss_translucency use_thickness_from_shadow use_transparency_overlap "
        "volume_intersection_method",
        INTERFACE: "metallic paint_active_slot paint_clone_slot preview_render_type roughness specular_color "
        "specular_intensity texture_paint_images texture_paint_slots use_preview_world",
        PASSES: "pass_index",
        UNSUPPORTED: "displacement_method grease_pencil is_grease_pencil line_color line_priority lineart "
        "use_transparent_shadow",
        INDIRECT: "animation_data cycles diffuse_color node_tree use_nodes",
    },
    "material.cycles": {
        SAMPLING: "emission_sampling",
        UNSUPPORTED: "use_bump_map_correction",
        NO_VOLUMES: "homogeneous_volume volume_interpolation volume_sampling volume_step_rate",
    },
    "camera": {
        INTERFACE: "background_images composition_guide_color display_size passepartout_alpha show_background_images "
        "show_composition_center show_composition_center_diagonal show_composition_golden "
        "show_composition_golden_tria_a show_composition_golden_tria_b show_composition_harmony_tri_a "
        "show_composition_harmony_tri_b show_composition_thirds show_limits show_mist show_name show_passepartout "
        "show_safe_areas show_safe_center show_sensor lens_unit",
        UNSUPPORTED: "central_cylindrical_radius central_cylindrical_range_u_max central_cylindrical_range_u_min "
        "central_cylindrical_range_v_max central_cylindrical_range_v_min custom_bytecode custom_bytecode_hash "
        "custom_filepath custom_mode custom_shader cycles_custom fisheye_fov fisheye_lens fisheye_polynomial_k0 "
        "fisheye_polynomial_k1 fisheye_polynomial_k2 fisheye_polynomial_k3 fisheye_polynomial_k4 latitude_max "
        "latitude_min longitude_max longitude_min panorama_type",
        INDIRECT: "angle_y animation_data dof ortho_scale sensor_height stereo",
    },
    "camera.dof": {
        UNSUPPORTED: "aperture_blades aperture_fstop aperture_ratio aperture_rotation focus_distance focus_object "
        "focus_subtarget"
    },
    "camera.stereo": {
        "read where a render has two views, by the engine's camera: test_camera": "convergence_distance "
        "convergence_mode interocular_distance pivot",
        "of panoramic cameras, which are refused": "pole_merge_angle_from pole_merge_angle_to use_pole_merge "
        "use_spherical_stereo",
    },
    "world": {
        EEVEE: "probe_resolution sun_angle sun_shadow_filter_radius sun_shadow_jitter_overblur "
        "sun_shadow_maximum_resolution sun_threshold use_eevee_finite_volume use_sun_shadow use_sun_shadow_jitter",
        INDIRECT: "animation_data color cycles cycles_visibility light_settings mist_settings node_tree use_nodes",
        PASSES: "lightgroup",
    },
    "world.cycles": {
        SAMPLING: "sample_map_resolution sampling_method",
        BOUNCES: "is_caustics_light max_bounces",
        NO_VOLUMES: "homogeneous_volume volume_interpolation volume_sampling volume_step_size",
        "the world's light has no shadows here but ambient occlusion": "use_shadows",
    },
    "world.cycles_visibility": {BOUNCES: "transmission scatter", SAMPLING: "shadow"},
    "world.light_settings": {"of Cycles' fast approximation of bounces, and of its pass": "ao_factor distance"},
    "world.mist_settings": {PASSES: "depth falloff height intensity start use_mist"},
    "object": {
        BY_BLENDER: "active_shape_key active_shape_key_index add_rest_position_attribute collision constraints data "
        "delta_rotation_quaternion dimensions field grease_pencil_modifiers instance_collection instance_faces_scale "
        "instance_type is_from_instancer is_from_set is_instancer matrix_basis matrix_local matrix_parent_inverse "
        "matrix_world modifiers parent parent_bone parent_bone_head_tail_factor parent_type parent_vertices "
        "particle_systems pose rigid_body rigid_body_constraint rotation_axis_angle rotation_mode rotation_quaternion "
        "shader_effects show_instancer_for_render hide_render show_only_shape_key soft_body "
        "track_axis type up_axis use_instance_faces_scale use_instance_vertices_rotation use_parent_final_indices "
        "use_simulation_cache vertex_groups animation_data material_slots active_material",
        INTERFACE: "active_material_index active_selection_set animation_visualization bound_box display "
        "display_bounds_type display_type empty_display_size empty_display_type empty_image_depth "
        "empty_image_offset empty_image_side hide_select hide_surface_pick hide_viewport image_user lock_location "
        "lock_rotation lock_rotation_w lock_rotations_4d lock_scale mode motion_path selection_sets show_all_edges "
        "show_axis show_bounds show_empty_image_only_axis_aligned show_empty_image_orthographic "
        "show_empty_image_perspective show_in_front show_name show_texture_space show_transparent show_wire "
        "use_camera_lock_parent use_dynamic_topology_sculpting use_empty_image_alpha use_mesh_mirror_x "
        "use_mesh_mirror_y use_mesh_mirror_z use_shape_key_edit_mode",
        EEVEE: "hide_probe_plane hide_probe_sphere hide_probe_volume",
        BOUNCES: "visible_diffuse visible_glossy visible_transmission visible_volume_scatter visible_raycast",
        UNSUPPORTED: "color lineart use_grease_pencil_lights",
        PASSES: "lightgroup pass_index",
        INDIRECT: "cycles light_linking",
        "this engine offsets the origins of shadow rays in another way": "shadow_terminator_geometry_offset "
        "shadow_terminator_normal_offset shadow_terminator_shading_offset",
    },
    "object.cycles": {
        "of motion blur, which is reported": "motion_steps use_deform_motion use_motion_blur",
        "used only with Simplify, to save Cycles' memory": "use_camera_cull use_distance_cull",
        "of Cycles' own subdivision; the modifier's is drawn": "dicing_rate use_adaptive_subdivision",
        "this engine offsets the origins of shadow rays in another way": "shadow_terminator_geometry_offset "
        "shadow_terminator_offset",
        BOUNCES: "ao_distance is_caustics_caster is_caustics_receiver",
    },
    "object.light_linking": {"read of lights; meshes emit no light: test_light_linking": "blocker_collection "
                             "receiver_collection"},
    "object.display": {INTERFACE: "show_shadows"},
    "view_layer": {
        INTERFACE: "active_aov active_aov_index active_layer_collection active_lightgroup active_lightgroup_index",
        BY_BLENDER: "depsgraph has_export_collections objects use",
        INDIRECT: "cycles eevee freestyle_settings layer_collection",
        "this engine has its own setting of samples": "samples",
        "of hair, volumes and grease pencil, which are reported; Cycles' occlusion": "use_strand use_volumes "
        "use_grease_pencil use_ao",
        "read by the engine's update_render_passes": "use_pass_ambient_occlusion use_pass_combined "
        "use_pass_normal use_pass_z",
        PASSES: "aovs lightgroups pass_alpha_threshold pass_cryptomatte_depth "
        "use_pass_cryptomatte_accurate use_pass_cryptomatte_asset use_pass_cryptomatte_material "
        "use_pass_cryptomatte_object use_pass_diffuse_color use_pass_diffuse_direct use_pass_diffuse_indirect "
        "use_pass_emit use_pass_environment use_pass_glossy_color use_pass_glossy_direct use_pass_glossy_indirect "
        "use_pass_grease_pencil use_pass_material_index use_pass_mist use_pass_object_index use_pass_position "
        "use_pass_shadow use_pass_subsurface_color use_pass_subsurface_direct use_pass_subsurface_indirect "
        "use_pass_transmission_color use_pass_transmission_direct use_pass_transmission_indirect use_pass_uv "
        "use_pass_vector",
    },
    "view_layer.cycles": {
        PASSES: "denoising_pass_follow_reflections denoising_pass_use_albedo_roughness_weighting "
        "denoising_store_passes pass_debug_sample_count pass_render_time use_pass_shadow_catcher "
        "use_pass_volume_direct use_pass_volume_indirect use_pass_volume_majorant use_pass_volume_scatter "
        "use_pass_volume_transmit",
        "a picture of this engine is not denoised": "use_denoising",
    },
    "view_layer.eevee": {EEVEE: "ambient_occlusion_distance use_pass_bloom use_pass_transparent "
                         "use_pass_volume_direct"},
    "layer_collection": {BY_BLENDER: "children collection hide_viewport is_visible"},
    "ImageTexture": {INDIRECT: "color_mapping image_user projection_blend texture_mapping"},
    "ImageTexture.texture_mapping": {
        INDIRECT: "vector_type", "of another renderer's textures": "mapping",
        "Cycles ignores them": "max min use_max use_min",
    },
    "ImageTexture.color_mapping": {
        "no window of Blender shows it": "blend_color blend_factor blend_type brightness color_ramp contrast "
        "saturation use_color_ramp"
    },
    "Principled": {UNSUPPORTED: "distribution subsurface_method"},
    "Diffuse": {},
    "Emission": {},
    "Background": {},
    "UVMap": {},
    "MaterialOutput": {INDIRECT: "is_active_output"},
    "WorldOutput": {INDIRECT: "is_active_output target"},
    "LightOutput": {INDIRECT: "is_active_output target"},
}  # fmt: skip

#: Inputs of drawn nodes and of output nodes: those that are read, and those that are reported when linked.
INPUTS: dict[str, tuple[str, str]] = {
    "Principled": (
        "Alpha|Base Color|Normal|Metallic|Roughness|IOR|Diffuse Roughness|Specular IOR Level|Anisotropic|Coat Weight|"
        "Sheen Weight|Emission Strength",
        "Subsurface Weight|Transmission Weight|Thin Film Thickness",
    ),
    "Diffuse": ("Color|Normal|Roughness", ""),
    "Emission": ("Color|Strength", ""),
    "Background": ("Color|Strength", ""),
    "ImageTexture": ("", "Vector"),
    "MaterialOutput": ("Surface|Displacement", "Volume"),
    "WorldOutput": ("Surface", "Volume"),
    "LightOutput": ("Surface", ""),
}

#: Inputs that have an effect only together with another input, which is read or reported.
DEPENDENT_INPUTS = (
    "Weight|Thin Wall|Subsurface Radius|Subsurface Scale|Subsurface IOR|Subsurface Anisotropy|Specular Tint|"
    "Anisotropic Rotation|Tangent|Coat Roughness|Coat IOR|Coat Tint|Coat Normal|Sheen Roughness|Sheen Tint|"
    "Emission Color|Thin Film IOR|Thickness"
)

# Tests of the libraries that need no GPU.

neuvv_test(base_test HOSTILE
  SOURCES
    base/child_program_test.cpp
    base/memory_group_test.cpp
    base/new_file_test.cpp
    base/text_test.cpp
    base/regular_file_test.cpp
    base/edit_lock_test.cpp
    base/stop_test.cpp
  LINKS neuvv_base)

neuvv_test(reference_test
  SOURCES
    reference_test/composite_test.cpp
    reference_test/hh_test.cpp
    reference_test/psi_test.cpp
    reference_test/slice_test.cpp
    reference_test/trace_test.cpp
    reference_test/training_test.cpp)

neuvv_test(voctree_test HOSTILE COST 12
  SOURCES
    voctree/half_test.cpp
    voctree/voctree_test.cpp
    voctree/round_test.cpp
    voctree/coarse_test.cpp
    voctree/nvv_test.cpp
    voctree/nvv_atomic_test.cpp
    voctree/edit_layer_test.cpp
    voctree/slice_paint_test.cpp
    voctree/tree_slice_test.cpp
    voctree/kinds_test.cpp
    voctree/plenoctree_test.cpp
    voctree/plenoctree_forms_test.cpp
    voctree/clip_index_test.cpp
    voctree/frames_test.cpp
    voctree/solid_leaves_test.cpp
  LINKS neuvv_clips neuvv_media PkgConfig::zstd PkgConfig::xxhash PkgConfig::libzip)

add_executable(nvv_alone voctree/nvv_alone.cpp)
target_link_libraries(nvv_alone PRIVATE neuvv_voctree neuvv_warnings)
add_test(NAME nvv_alone COMMAND nvv_alone ${CMAKE_CURRENT_SOURCE_DIR}/fuzz/corpus/nvv/tiny/scene.nvv)
set_tests_properties(nvv_alone PROPERTIES LABELS cpu)
add_dependencies(cpu_tests nvv_alone)
add_dependencies(usual_tests nvv_alone)

neuvv_test(slice_test
  SOURCES
    slice/slice_test.cpp
  LINKS neuvv_slice neuvv_media)

neuvv_test(stream_test HOSTILE
  SOURCES
    stream/block_cache_test.cpp
    stream/rans_test.cpp
    stream/transform_test.cpp
    stream/frame_codec_test.cpp
    stream/group_decoder_test.cpp
    stream/transfer_watch_test.cpp
    stream/nvs_test.cpp
    stream/http_test.cpp
    stream/download_test.cpp
    stream/served_sound_test.cpp
    stream/nginx_test.cpp
    stream/vectors_test.cpp
  LINKS neuvv_clips nlohmann_json::nlohmann_json)
target_compile_definitions(stream_test PRIVATE NEUVV_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
# The same vectors by a reader that was written by the format's page alone.
add_test(NAME stream_vectors_in_python COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/stream/read_nvs.py
         ${CMAKE_CURRENT_SOURCE_DIR}/stream/vectors/small.nvs ${CMAKE_CURRENT_SOURCE_DIR}/stream/vectors/usual.nvs
         ${CMAKE_CURRENT_SOURCE_DIR}/stream/vectors/fine.nvs)
set_tests_properties(stream_vectors_in_python PROPERTIES LABELS cpu)
# And by the decoder as browsers run it, where emscripten and Node are.
add_test(NAME stream_vectors_in_webassembly COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/stream/webassembly/check)
set_tests_properties(stream_vectors_in_webassembly PROPERTIES LABELS cpu SKIP_RETURN_CODE 77)

# The player for browsers, where emscripten and Chromium are; its tests share one build of it.
set(player ${CMAKE_CURRENT_BINARY_DIR}/web)
add_test(NAME web_build COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/web/build ${player})
set_tests_properties(web_build PROPERTIES LABELS gpu FIXTURES_SETUP web_build)
foreach(part frames player stall hidden looks headset three one_file)
  add_test(NAME web_${part}
           COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/web/check ${part} $<TARGET_FILE:neuvv> ${player})
  set_tests_properties(web_${part} PROPERTIES LABELS gpu SKIP_RETURN_CODE 77 FIXTURES_REQUIRED web_build)
endforeach()
# How soon they go on is compared with the clock.
set_tests_properties(web_hidden web_stall web_looks PROPERTIES RUN_SERIAL ON)

neuvv_test(media_test HOSTILE
  SOURCES
    media/image_test.cpp
    media/exr_test.cpp
    media/deep_exr_test.cpp
    media/cryptomatte_test.cpp
    media/image_sink_test.cpp
    media/video_test.cpp
    media/shown_test.cpp
    media/sound_test.cpp
    media/sound_peaks_test.cpp
  LINKS neuvv_media PNG::PNG JPEG::JPEG PkgConfig::openexr PkgConfig::ffmpeg)
neuvv_test(dataset_test HOSTILE
  SOURCES
    training/dataset_test.cpp
    training/lens_test.cpp
    training/images_test.cpp
    training/write_dataset_test.cpp
    training/tiled_image_test.cpp
    training/layouts/nerf_test.cpp
    training/layouts/colmap_test.cpp
    training/layouts/easymocap_test.cpp
    training/layouts/n3v_test.cpp
    training/camera_path_file_test.cpp
    training/camera_path_write_test.cpp
    training/plenoctree_pose_test.cpp
    fuzz/fuzz_test.cpp
    fuzz/mutate.cpp
    fuzz/verdict.cpp
  LINKS neuvv_data neuvv_motion nlohmann_json::nlohmann_json PkgConfig::libzip)

neuvv_test(layouts_test HOSTILE
  SOURCES
    training/layouts/actorshq_test.cpp
    training/layouts/metashape_test.cpp
    training/layouts/realitycapture_test.cpp
    training/layouts/qualisys_test.cpp
    training/layouts/pose2sim_test.cpp
    training/layouts/opencv_cameras_test.cpp
    training/layouts/dynamic3dgs_test.cpp
    training/layouts/panoptic_test.cpp
    training/layouts/polycam_test.cpp
    training/layouts/record3d_test.cpp
    training/layouts/clip_times_test.cpp
    training/layouts/presentation_test.cpp
    training/layouts/candidates_test.cpp
    training/layouts/splits_test.cpp
    training/layouts/every_layout_test.cpp
    training/layouts/world_of_rig_test.cpp
  LINKS neuvv_data nlohmann_json::nlohmann_json JPEG::JPEG PkgConfig::ffmpeg)
target_compile_definitions(layouts_test PRIVATE NEUVV_SOURCE_DIR="${PROJECT_SOURCE_DIR}")

neuvv_test(metrics_test
  SOURCES
    training/evaluation/metrics_test.cpp
    training/evaluation/flicker_test.cpp
    training/evaluation/flip_test.cpp
  LINKS neuvv_training)

neuvv_test(lpips_test SOURCES training/evaluation/lpips_test.cpp LINKS neuvv_lpips PkgConfig::libzip)
neuvv_test(matte_test
  SOURCES
    training/mattes/brought_mattes_test.cpp
    training/mattes/figure_test.cpp
    training/mattes/matte_test.cpp
    training/mattes/matte_model_test.cpp
    training/mattes/network_mattes_test.cpp
    training/pixel_mask_test.cpp
  LINKS neuvv_training)
neuvv_test(camera_pose_test
  SOURCES
    training/camera_pose_test.cpp
    training/rig_changes_test.cpp
    training/rig_file_test.cpp
    training/segments_test.cpp
    training/claim_test.cpp
  LINKS neuvv_training)

neuvv_test(motion_test HOSTILE COST 10
  SOURCES
    motion/detector.cpp
    motion/extract_test.cpp
    motion/people_test.cpp
    motion/skeleton_file_test.cpp
    motion/motion_files_test.cpp
    motion/bvh_test.cpp
    motion/key_points_test.cpp
    motion/trainee.cpp
    motion/compare_test.cpp
    motion/live_test.cpp
    motion/colour_model.cpp
    motion/key_point_detector_test.cpp
    motion/network_test.cpp
    motion/vmc_test.cpp
    motion/pose_source_test.cpp
    motion/pose_port_test.cpp
    motion/bone_names_test.cpp
    motion/skeleton_space_test.cpp
  LINKS neuvv_motion PkgConfig::liblo)
target_compile_definitions(motion_test PRIVATE NEUVV_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
neuvv_test(coach_test COST 5
  SOURCES
    motion/detector.cpp
    motion/trainee.cpp
    support/body_tree.cpp
    coach/coach_test.cpp
    coach/body_test.cpp
  LINKS neuvv_coach)
target_compile_definitions(coach_test PRIVATE NEUVV_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
neuvv_test(stage_test HOSTILE
  SOURCES
    stage/gltf_scene_test.cpp
    stage/gltf_animation_test.cpp
    stage/gltf_tolerance_test.cpp
    stage/gltf_hostile_test.cpp
    stage/gltf_materials_test.cpp
    stage/json_splice_test.cpp
    stage/stage_json_test.cpp
    stage/time_map_test.cpp
    stage/heard_test.cpp
    stage/heard_peaks_test.cpp
    stage/pan_test.cpp
    stage/stage_sound_test.cpp
    stage/stage_file_test.cpp
    stage/embedded_test.cpp
    stage/stage_test.cpp
    stage/camera_path_test.cpp
  LINKS neuvv_stage nlohmann_json::nlohmann_json)
target_compile_definitions(stage_test PRIVATE NEUVV_SOURCE_DIR="${PROJECT_SOURCE_DIR}")

neuvv_test(interchange_test HOSTILE
  SOURCES
    interchange/splats_test.cpp
    interchange/splat_files_test.cpp
    interchange/plenoctree_npz_test.cpp
    interchange/surface_test.cpp
    interchange/meshes_test.cpp
    reference/splats.cpp
  LINKS neuvv_interchange nlohmann_json::nlohmann_json PkgConfig::libzip)
neuvv_test(vdb_test HOSTILE COST 10
  SOURCES
    interchange/vdb_test.cpp
    interchange/vdb_reader_test.cpp
    fuzz/mutate.cpp
  LINKS neuvv_interchange neuvv_openvdb)
neuvv_test(splat_import_test HOSTILE
  SOURCES
    interchange/splat_import_test.cpp
    reference/splats.cpp
    fuzz/mutate.cpp
  LINKS neuvv_interchange)

neuvv_test(edit_test
  SOURCES
    edit/operations_test.cpp
    edit/copies_test.cpp
    edit/history_test.cpp
    edit/sharing_test.cpp
    edit/recovery_test.cpp
    edit/nodes_test.cpp
    edit/camera_keys_test.cpp
    edit/time_edit_test.cpp
    edit/read_test.cpp
    edit/light_values_test.cpp
    edit/tracks_test.cpp
    edit/paint_layers_test.cpp
  LINKS neuvv_edit)
target_include_directories(edit_test PRIVATE ${PROJECT_SOURCE_DIR})

# Tests of passes, images and training, which need a Vulkan device.

# GPU tests; their own shaders are embedded as the program's are.
neuvv_shaders(neuvv_render_test_shaders render/hh_probe.comp render/light_probe.comp)
neuvv_shaders(neuvv_gpu_test_shaders gpu/debug_probe.comp)
neuvv_test(gpu_test GPU
  SOURCES
    gpu/gpu_test.cpp
    gpu/buffer_profile_test.cpp
    gpu/buffer_speed_test.cpp
    gpu/memory_test.cpp
    gpu/debug_buffer_test.cpp
  LINKS neuvv_gpu neuvv_render_shaders neuvv_xr_shaders neuvv_training_shaders neuvv_gpu_test_shaders)
neuvv_test(transfer_queue_test GPU SOURCES gpu/transfer_queue_test.cpp LINKS neuvv_gpu)
add_dependencies(transfer_queue_test neuvv_transfer_queue)
target_compile_definitions(transfer_queue_test PRIVATE NEUVV_TRANSFER_QUEUE_LAYER="${CMAKE_CURRENT_BINARY_DIR}/transfer_queue")
neuvv_test(render_test GPU
  SHARDS 2 COST 60
  SOURCES
    render/hh_test.cpp
    render/slice_test.cpp
    render/slice_tree_test.cpp
    render/slice_upload_test.cpp
    render/paint_test.cpp
    render/pick_test.cpp
    render/frame_test.cpp
    render/submit_test.cpp
    render/memory_test.cpp
    render/field_levels_test.cpp
    render/instances_test.cpp
    render/highlight_test.cpp
    render/inspect_test.cpp
    render/merge_test.cpp
    render/resolve_test.cpp
    render/shadow_blur_test.cpp
    render/linear_image_test.cpp
    render/shown_segments_test.cpp
    render/ray_grid_test.cpp
    render/srgb_colours_test.cpp
  LINKS neuvv_render neuvv_reference_paths neuvv_render_test_shaders)
neuvv_test(layers_test GPU SOURCES render/image_layers_test.cpp LINKS neuvv_render)
neuvv_test(paint_tools_test GPU SOURCES edit/paint_tools_test.cpp LINKS neuvv_edit)
neuvv_test(golden_test GPU COST 40
  SOURCES
    golden/golden.cpp
    golden/golden_test.cpp
    golden/paint_golden_test.cpp
    golden/coach_golden_test.cpp
    golden/scenes.cpp
    golden/set_scenes.cpp
    golden/stage_scenes.cpp
    motion/detector.cpp
    motion/trainee.cpp
    support/body_tree.cpp
  LINKS neuvv_tools neuvv_edit nlohmann_json::nlohmann_json)
target_include_directories(golden_test PRIVATE ${PROJECT_SOURCE_DIR})
neuvv_storage_test(golden_test GoldenTest.* * 1 30)
target_compile_definitions(golden_test PRIVATE NEUVV_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                           NEUVV_GOLDEN_DIR="${CMAKE_CURRENT_SOURCE_DIR}/golden"
                           NEUVV_GOLDEN_FAILURES="${CMAKE_BINARY_DIR}/golden-failures")

neuvv_test(raster_test GPU SOURCES render/raster_test.cpp LINKS neuvv_render nlohmann_json::nlohmann_json)
target_include_directories(raster_test PRIVATE ${PROJECT_SOURCE_DIR})
neuvv_test(set_raster_test GPU
  SHARDS 2 COST 60
  SOURCES
    render/set_raster_test.cpp
    render/set_frame_test.cpp
    render/frame_passes_test.cpp
    render/set_material_test.cpp
    render/set_shadow_test.cpp
    render/environment_test.cpp
    render/stage_renderer_test.cpp
    render/stage_renderer_size_test.cpp
  LINKS neuvv_render neuvv_render_test_shaders nlohmann_json::nlohmann_json)
target_include_directories(set_raster_test PRIVATE ${PROJECT_SOURCE_DIR})
neuvv_storage_test(render_test "SliceT*:SliceU*:FrameTest.TraceAndDirect*:FrameTest.ShadedP*:MergeTest.Inst*:PaintTest.Every*:Highlight*:Inspect*:Pick*" * 2 25)
neuvv_storage_test(set_raster_test "SetFrameTest.TheSetShadows*:SetShadowTest.Perf*:SetShadowTest.Comp*:FramePasses*" * 2 25)
neuvv_gpu_assisted_test(render_test "SliceTree*:Instances*:RayGrid*:Merge*" 200)
neuvv_gpu_assisted_test(set_raster_test "SetFrameTest.TheSet*:SetFrameTest.Glass*:SetShadow*" 50)
neuvv_test(stage_clips_test GPU
  SOURCES
    render/frame_pace_test.cpp
    render/ladder_test.cpp
    render/stage_clips_test.cpp
    render/stage_stream_test.cpp
    render/stage_pick_test.cpp
  LINKS neuvv_edit nlohmann_json::nlohmann_json)
target_compile_definitions(stage_clips_test PRIVATE NEUVV_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
neuvv_test(capture_test GPU COST 30
  SOURCES training/capture/dome_test.cpp training/capture/capture_test.cpp training/capture/studio_test.cpp
  LINKS neuvv_training nlohmann_json::nlohmann_json)
target_compile_definitions(capture_test PRIVATE NEUVV_SOURCE_DIR="${PROJECT_SOURCE_DIR}")

# Training, forwards and backwards.
neuvv_test(gradient_test GPU
  SHARDS 2 COST 40
  SOURCES
    gradient/scene.cpp
    gradient/chain.cpp
    gradient/chain_test.cpp
    gradient/loss_test.cpp
    gradient/trace_adjoint_test.cpp
    gradient/adam_test.cpp
    gradient/psi_test.cpp
  LINKS neuvv_training)
neuvv_test(training_test GPU COST 30
  SOURCES
    training/hull_box_test.cpp
    training/hull_test.cpp
    training/doubtful_mattes_test.cpp
    training/misfits_test.cpp
    training/camera_check_test.cpp
    training/bases_test.cpp
    training/grow_test.cpp
    training/surroundings_test.cpp
    training/merge_test.cpp
    training/revive_test.cpp
    training/batch_test.cpp
    training/first_colours_test.cpp
    training/schedule_test.cpp
    training/compact_test.cpp
    training/checkpoint_test.cpp
    training/team_test.cpp
  LINKS neuvv_training nlohmann_json::nlohmann_json)
neuvv_storage_test(gradient_test "ChainGradient*:PsiTest.L*:AdamTest.*" * 1 25)
neuvv_storage_test(training_test Team* Team* 1 5)
neuvv_test(train_test GPU
  SMOKE "-KilledRun.LeavesAVolume*:KilledRun.SurvivesAKill*:KilledRun.TheSignals*:KilledRun.RefinesOnly*:KilledRun.CtrlCInTheSearch*:TrainTest.TheSameSeed*:CameraColourTest.AResumed*:RigSearchTest.ARun*:RigSearchTest.ExactCameras*:RigSearchTest.TakesAFifth*:RigSearchTest.ALate*"
  SHARDS 3 COST 60
  SOURCES
    training/train_test.cpp
    training/camera_colour_test.cpp
    training/rig_search_test.cpp
    training/align_rig_test.cpp
    training/preview_test.cpp
    training/psi_tree_test.cpp
  LINKS neuvv_training nlohmann_json::nlohmann_json)
target_compile_definitions(train_test PRIVATE NEUVV_PROGRAM="$<TARGET_FILE:neuvv>" NEUVV_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
add_dependencies(train_test neuvv)

# Tests of neuvv and neuvv-bench as their users run them, of what window and headset share, and of both.

# The program as its user runs it. tools_test needs no GPU.
neuvv_test(tools_test COST 8
  SOURCES
    tools/options_test.cpp
    tools/remedies_test.cpp
    tools/results_test.cpp
    tools/ranks_test.cpp
    tools/clip_verb_test.cpp
    tools/view_path_test.cpp
    tools/eval_page_test.cpp
    tools/cli_test.cpp
    tools/dataset_verb_test.cpp
    tools/stage_verb_test.cpp
    tools/cli_web_page_test.cpp
    tools/cli_skeleton_test.cpp
    motion/detector.cpp
    motion/trainee.cpp
    motion/colour_model.cpp
  LINKS neuvv_tools PkgConfig::liblo nlohmann_json::nlohmann_json)
neuvv_test(cli_gpu_test GPU
  SMOKE "CliSegments.OnAStage*:CliMpiTraining.RanksShare*:CliCoach.AMistake*:CliImport.Frames*:CliSound.AVideoOf*:CliStage.EveryEdit*:CliPaint.Regions*:CliStagePaint.AnImage*:CliPublish.AStream*:CliPublish.AStagePlays*:CliExport.SplatsShow*:CliMesh.Glb*:CliGpu.RenderWrites*:CliGpu.EvalWrites*:CliGpu.EveryOptionOfTrain*:CliBenchmark.ActorsHq*:CliDevice.Device*:CliRender.Ranks*"
  SHARDS 4 COST 60
  SOURCES
    tools/cli_capture_test.cpp
    tools/cli_gpu_test.cpp
    tools/cli_eval_test.cpp
    tools/cli_benchmark_test.cpp
    tools/cli_train_options_test.cpp
    tools/cli_device_test.cpp
    tools/cli_render_test.cpp
    tools/cli_stage_test.cpp
    tools/cli_paint_test.cpp
    tools/cli_publish_test.cpp
    tools/cli_export_test.cpp
    tools/cli_import_test.cpp
    reference/splats.cpp
    tools/cli_sound_test.cpp
    tools/cli_paint_segments_test.cpp
    tools/cli_segments_test.cpp
    tools/cli_segments_training_test.cpp
    tools/cli_shared_training_test.cpp
    tools/cli_coach_test.cpp
    motion/detector.cpp
    motion/trainee.cpp
    support/body_tree.cpp
  LINKS neuvv_tools neuvv_interchange nlohmann_json::nlohmann_json)
neuvv_test(cli_layers_test GPU COST 20 SOURCES tools/cli_layers_test.cpp LINKS neuvv_tools nlohmann_json::nlohmann_json PkgConfig::openexr)
foreach(test tools_test cli_gpu_test cli_layers_test)
  add_dependencies(${test} neuvv)
  target_compile_definitions(${test} PRIVATE NEUVV_PROGRAM="$<TARGET_FILE:neuvv>"
                             NEUVV_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
endforeach()
add_dependencies(cli_gpu_test neuvv_lose_device neuvv_lower_limits neuvv_transfer_queue)
target_compile_definitions(cli_gpu_test PRIVATE NEUVV_LOSE_DEVICE_LAYER="${CMAKE_CURRENT_BINARY_DIR}/lose_device"
                           NEUVV_LOWER_LIMITS_LAYER="${CMAKE_CURRENT_BINARY_DIR}/lower_limits"
                           NEUVV_TRANSFER_QUEUE_LAYER="${CMAKE_CURRENT_BINARY_DIR}/transfer_queue")

add_test(NAME install_packages_test
         COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/tools/install_packages_test ${PROJECT_SOURCE_DIR}/tools)
set_tests_properties(install_packages_test PROPERTIES LABELS cpu)

# A real Slurm of one node.
if(NOT NEUVV_SANITIZE)
  add_test(NAME slurm_test COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/slurm/slurm_test $<TARGET_FILE:neuvv>)
  set_tests_properties(slurm_test PROPERTIES LABELS "gpu;full" COST 140 TIMEOUT 900 SKIP_RETURN_CODE 77)
endif()

if(NOT NEUVV_SANITIZE)
  add_test(NAME gpu_report_test COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/tools/gpu_report_test.py
           ${PROJECT_SOURCE_DIR}/tools/gpu-report ${CMAKE_CURRENT_BINARY_DIR}/gpu-report)
  set_tests_properties(gpu_report_test PROPERTIES LABELS "gpu;full" COST 60 TIMEOUT 900)
endif()

add_test(NAME measurements_test COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/tools/measurements_test.py ${PROJECT_SOURCE_DIR}
         ${CMAKE_CURRENT_BINARY_DIR}/measurements)
set_tests_properties(measurements_test PROPERTIES LABELS cpu COST 1)

if(NOT NEUVV_SANITIZE)
  add_test(NAME guide_test COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/tools/guide_test.py $<TARGET_FILE:neuvv>
           $<TARGET_FILE:neuvv-bench> ${PROJECT_SOURCE_DIR})
  set_tests_properties(guide_test PROPERTIES LABELS gpu COST 30 TIMEOUT 300)
endif()

# neuvv-bench as its user runs it, and the rasteriser of leaves that it measures.
neuvv_test(bench_test GPU
  SMOKE "Bench.*:CliGpu.BenchSlice*:LeafRaster*:PairSort*" COST 60
  SOURCES
    bench/cli_bench_test.cpp
    bench/leaf_raster_test.cpp
    bench/pair_sort_test.cpp
    motion/detector.cpp
    support/body_tree.cpp
  LINKS neuvv_leaf_raster neuvv_tools nlohmann_json::nlohmann_json)
add_dependencies(bench_test neuvv-bench)
target_compile_definitions(bench_test PRIVATE NEUVV_PROGRAM="$<TARGET_FILE:neuvv-bench>"
                           NEUVV_SOURCE_DIR="${PROJECT_SOURCE_DIR}")

# The open document and what both faces share, without a window; editor_gpu_test draws.
neuvv_test(editor_test
  SOURCES
    editor/autosave_test.cpp
    editor/block_grid_test.cpp
    editor/clock_test.cpp
    editor/device_losses_test.cpp
    editor/document_saver_test.cpp
    editor/dynamic_scale_test.cpp
    editor/editor_test.cpp
    editor/open_file_test.cpp
    editor/paint_operation_test.cpp
    editor/paint_spread_test.cpp
    editor/pointer_test.cpp
    editor/set_surface_test.cpp
    editor/shader_sources_test.cpp
    editor/sound_player_test.cpp
    editor/waveforms_test.cpp
  LINKS neuvv_editor neuvv_render_shaders nlohmann_json::nlohmann_json)
target_include_directories(editor_test PRIVATE ${PROJECT_SOURCE_DIR})
target_compile_definitions(editor_test PRIVATE NEUVV_SHADERS="${PROJECT_SOURCE_DIR}/shaders" NEUVV_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
neuvv_test(editor_gpu_test GPU SOURCES editor/paint_session_test.cpp editor/render_thread_test.cpp LINKS neuvv_editor nlohmann_json::nlohmann_json)
target_include_directories(editor_gpu_test PRIVATE ${PROJECT_SOURCE_DIR})
target_compile_definitions(editor_gpu_test PRIVATE NEUVV_SOURCE_DIR="${PROJECT_SOURCE_DIR}")

# What the desktop viewer computes without a window.
neuvv_test(viewer_test
  SOURCES
    viewer/camera_keys_test.cpp
    viewer/gizmo_test.cpp
    viewer/light_gizmo_test.cpp
    viewer/navigation_test.cpp
    viewer/node_transform_test.cpp
    viewer/preferences_test.cpp
    viewer/stage_rows_test.cpp
    viewer/time_axis_test.cpp
    viewer/verb_test.cpp
  LINKS neuvv_viewer nlohmann_json::nlohmann_json)
target_include_directories(viewer_test PRIVATE ${PROJECT_SOURCE_DIR})
neuvv_test(export_test GPU COST 5 SOURCES viewer/export_test.cpp LINKS neuvv_viewer nlohmann_json::nlohmann_json)
target_include_directories(export_test PRIVATE ${PROJECT_SOURCE_DIR})

# Vulkan layers with their manifests, in one folder each: by lose_device, programs lose their device
# (support/losable_device.h); by lower_limits, devices have lower limits, or say that they are GPUs; by transfer_queue, they
# have a queue for copies.
foreach(layer lose_device lower_limits transfer_queue)
  add_library(neuvv_${layer} MODULE support/layers/${layer}.cpp)
  set_target_properties(neuvv_${layer} PROPERTIES CXX_VISIBILITY_PRESET hidden)
  target_include_directories(neuvv_${layer} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
  target_link_libraries(neuvv_${layer} PRIVATE neuvv_warnings Vulkan::Headers)
  file(GENERATE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/${layer}/layer.json
       CONTENT "{\"file_format_version\": \"1.0.0\",
\"layer\": {\"name\": \"VK_LAYER_NEUVV_${layer}\", \"type\": \"GLOBAL\",
\"library_path\": \"$<TARGET_FILE:neuvv_${layer}>\", \"api_version\": \"1.3.0\",
\"implementation_version\": \"1\", \"description\": \"for tests\"}}
")
endforeach()

# The desktop viewer as its user has it, on a screen without a monitor; each case has a screen of its own.
add_library(neuvv_hands STATIC viewer_window/hands.cpp)
target_include_directories(neuvv_hands PUBLIC ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
target_link_libraries(neuvv_hands PUBLIC neuvv_media nlohmann_json::nlohmann_json PRIVATE neuvv_warnings GTest::gtest)
target_compile_definitions(neuvv_hands PRIVATE VK_NO_PROTOTYPES NEUVV_PROGRAM="$<TARGET_FILE:neuvv>")
neuvv_precompile(neuvv_hands test)
neuvv_test(viewer_window_test GPU
  SMOKE "ViewerWindow*:Watching.TheWindowShowsWhatRenderDraws:Watching.PlaysAndPauses:Editing.AStrokeIsSeen*:Arranging.TheGizmo*:Coaching.ClicksBegin*:Exporting.AClipIs*:Losing.ADevice*"
  SHARDS 4 COST 90
  SOURCES
    viewer_window/watching_test.cpp
    viewer_window/editing_test.cpp
    viewer_window/arranging_test.cpp
    viewer_window/coaching_test.cpp
    viewer_window/exporting_test.cpp
    viewer_window/losing_test.cpp
    motion/detector.cpp
    motion/trainee.cpp
  LINKS neuvv_hands neuvv_edit neuvv_motion nlohmann_json::nlohmann_json)
add_dependencies(viewer_window_test neuvv neuvv_lose_device)
target_include_directories(viewer_window_test PRIVATE ${PROJECT_SOURCE_DIR})
target_compile_definitions(viewer_window_test PRIVATE NEUVV_PROGRAM="$<TARGET_FILE:neuvv>" NEUVV_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                           NEUVV_SHADERS="${PROJECT_SOURCE_DIR}/shaders"
                           NEUVV_LOSE_DEVICE_LAYER="${CMAKE_CURRENT_BINARY_DIR}/lose_device")
add_executable(viewer_measure viewer_window/measure.cpp)
target_link_libraries(viewer_measure PRIVATE neuvv_hands neuvv_warnings GTest::gtest)
target_compile_definitions(viewer_measure PRIVATE NEUVV_PROGRAM="$<TARGET_FILE:neuvv>")
add_dependencies(viewer_measure neuvv)

# Headsets: the geometry of hands; and the program itself, against an OpenXR runtime of our own.
add_subdirectory(xr_runtime)
neuvv_test(xr_test
  SOURCES
    xr/pose_test.cpp
    xr/analogue_input_test.cpp
    xr/ray_hit_test.cpp
    xr/grab_test.cpp
    xr/locomotion_test.cpp
    xr/eye_camera_test.cpp
    xr/eye_shapes_test.cpp
    xr/hand_tracking_test.cpp
    xr/bindings_test.cpp
    xr/body_points_test.cpp
  LINKS neuvv_xr)
target_include_directories(xr_test PRIVATE ${PROJECT_SOURCE_DIR})
neuvv_test(xr_body_test GPU COST 5 SOURCES xr/body_tracking_test.cpp LINKS neuvv_xr nlohmann_json::nlohmann_json)
add_dependencies(xr_body_test neuvv_xr_runtime)
target_include_directories(xr_body_test PRIVATE ${PROJECT_SOURCE_DIR})
target_compile_definitions(xr_body_test PRIVATE NEUVV_XR_RUNTIME="${CMAKE_CURRENT_BINARY_DIR}/xr_runtime/neuvv_xr_runtime.json")
neuvv_test(headset_test
  SOURCES
    headset/interaction_test.cpp
    headset/arrange_test.cpp
    headset/pointing_test.cpp
    headset/standing_test.cpp
    headset/hand_painter_test.cpp
    headset/ray_brush_test.cpp
    headset/settings_test.cpp
    headset/hand_shapes_test.cpp
    headset/drawn_share_test.cpp
    headset/labels_test.cpp
    headset/next_document_test.cpp
    headset/coaching_test.cpp
    headset/performer_pages_test.cpp
    headset/lights_test.cpp
    headset/panel_test.cpp
    headset/performer_edits_test.cpp
    headset/notice_plate_test.cpp
  LINKS neuvv_headset nlohmann_json::nlohmann_json)
target_include_directories(headset_test PRIVATE ${PROJECT_SOURCE_DIR})
neuvv_test(xr_runtime_test GPU
  SHARDS 2 COST 40
  SOURCES
    xr_runtime_test/application.cpp
    xr_runtime_test/application_device.cpp
    xr_runtime_test/application_test.cpp
    xr_runtime_test/liberties_test.cpp
    xr_runtime_test/script_test.cpp
    xr_runtime_test/violations_test.cpp
    xr_runtime_test/action_violations.cpp
    xr_runtime_test/frame_violations.cpp
    xr_runtime_test/input_violations.cpp
    xr_runtime_test/layer_violations.cpp
    xr_runtime_test/parameter_violations.cpp
    xr_runtime_test/session_violations.cpp
    xr_runtime_test/setup_violations.cpp
    xr_runtime_test/struct_violations.cpp
    xr_runtime_test/swapchain_violations.cpp
  LINKS neuvv_volk PkgConfig::openxr nlohmann_json::nlohmann_json)
add_dependencies(xr_runtime_test neuvv_xr_runtime)
target_include_directories(xr_runtime_test PRIVATE ${PROJECT_SOURCE_DIR})
target_compile_definitions(xr_runtime_test PRIVATE
                           NEUVV_XR_RUNTIME="${CMAKE_CURRENT_BINARY_DIR}/xr_runtime/neuvv_xr_runtime.json"
                           NEUVV_XR_RUNTIME_README="${CMAKE_CURRENT_SOURCE_DIR}/xr_runtime/README.md")
neuvv_test(xr_session_test GPU
  SMOKE "Watching.BothEyes*:Watching.EachEye*:Watching.CheckSays*:Editing.TwoHandsScale:Editing.ABrush*:Faults.ALostSession*:Panel.BothEyes*:Room.IsSeenByPassthrough:NarrowViews.AreDrawn*"
  SHARDS 4 COST 60
  SOURCES
    xr_session/xr_session.cpp
    xr_session/replay.cpp
    xr_session/watching_test.cpp
    xr_session/eyes_test.cpp
    xr_session/editing_test.cpp
    xr_session/faults_test.cpp
    xr_session/mirror_test.cpp
    xr_session/opening_test.cpp
    xr_session/pointing_test.cpp
    xr_session/recentring_test.cpp
    xr_session/coaching_test.cpp
    golden/golden.cpp
    xr_session/panel_test.cpp
  LINKS neuvv_hands neuvv_headset neuvv_training nlohmann_json::nlohmann_json)
add_dependencies(xr_session_test neuvv neuvv_xr_runtime neuvv_lose_device neuvv_lower_limits)
target_include_directories(xr_session_test PRIVATE ${PROJECT_SOURCE_DIR})
target_compile_definitions(xr_session_test PRIVATE NEUVV_PROGRAM="$<TARGET_FILE:neuvv>"
                           NEUVV_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                           NEUVV_LOSE_DEVICE_LAYER="${CMAKE_CURRENT_BINARY_DIR}/lose_device"
                           NEUVV_LOWER_LIMITS_LAYER="${CMAKE_CURRENT_BINARY_DIR}/lower_limits"
                           NEUVV_XR_RUNTIME="${CMAKE_CURRENT_BINARY_DIR}/xr_runtime/neuvv_xr_runtime.json"
                           NEUVV_GOLDEN_DIR="${CMAKE_CURRENT_SOURCE_DIR}/golden"
                           NEUVV_GOLDEN_FAILURES="${CMAKE_BINARY_DIR}/golden-failures")
neuvv_storage_test(xr_session_test "Watching.BothEyes*:Watching.EachEye*" "Watching.BothEyes*:Watching.EachEye*" 1 15)

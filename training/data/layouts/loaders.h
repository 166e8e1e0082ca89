// The loaders of layouts. For each of them, has_…_files() says whether a folder has the layout, and read_…_rig() reads
// its cameras and where each image lies; README.md says of which fields. All throw InputError with file, place and fix.
// has_…_session() says whether the session of a folder has the layout's calibration.
//
// Where a comment says nothing else, every 8th camera with images (the first, the 9th, … in natural order of their
// names) is held out for the test split, and cameras without images are left out.
#pragma once

#include <filesystem>

#include "training/data/layouts/rig/rig.h"

namespace neuvv::training {

// ActorsHQ: calibration.csv beside rgbs/ and masks/, of one scale.
bool has_actorshq_files(const std::filesystem::path& folder);
Rig read_actorshq_rig(const std::filesystem::path& folder, Split split);

// COLMAP: the sparse model in `folder`/sparse/0, sparse, colmap/sparse/0 or the folder itself.
bool has_colmap_files(const std::filesystem::path& folder);
Rig read_colmap_rig(const std::filesystem::path& folder, Split split);

// Dynamic 3D Gaussians: train_meta.json and test_meta.json, whose cameras are the held-out ones, beside ims/ and seg/.
bool has_dynamic3dgs_files(const std::filesystem::path& folder);
Rig read_dynamic3dgs_rig(const std::filesystem::path& folder, Split split);

// EasyMocap, and ZJU-MoCap and EasyVolcap in its layout: intri.yml, extri.yml and a folder of images per camera. The
// order of cameras is that of `names`.
bool has_easymocap_files(const std::filesystem::path& folder);
Rig read_easymocap_rig(const std::filesystem::path& folder, Split split);

// Agisoft Metashape: cameras.xml, beside images or videos by camera.
bool has_metashape_files(const std::filesystem::path& folder);
Rig read_metashape_rig(const std::filesystem::path& folder, Split split);

// Neural 3D Video and other captures in the layout of LLFF: poses_bounds.npy beside one video per camera. The camera of
// the first row is the test split, the others are the training split. Frame i of n has the time i/(n−1), where n is the
// number of frames of the shortest video.
bool has_n3v_files(const std::filesystem::path& folder);
Rig read_n3v_rig(const std::filesystem::path& folder, Split split);

// The NeRF family: images beside `folder`/transforms_train.json, _test.json or _val.json, or else the split's frames of
// a single transforms.json: those that its {train,test,val}_filenames list, else every 8th camera is held out.
bool has_nerf_files(const std::filesystem::path& folder);
Rig read_nerf_rig(const std::filesystem::path& folder, Split split);

// OpenCV's cv::FileStorage: every YAML file of the folder or of its folder calibration/ that has a camera matrix is a
// camera, with the file's name.
bool has_opencv_files(const std::filesystem::path& folder);
Rig read_opencv_rig(const std::filesystem::path& folder, Split split);

// CMU Panoptic Studio: calibration_NAME.json beside images or videos by camera, of whose types one is read.
bool has_panoptic_files(const std::filesystem::path& folder);
Rig read_panoptic_rig(const std::filesystem::path& folder, Split split);

// Raw data that the app Polycam exported: keyframes/, with an image and a JSON file for each place where the phone was.
// Every image is a camera of its own, and all of them show one frame.
bool has_polycam_files(const std::filesystem::path& folder);
Rig read_polycam_rig(const std::filesystem::path& folder, Split split);

// Pose2Sim or anipose: Calib.toml, beside videos or images by camera.
bool has_pose2sim_files(const std::filesystem::path& folder);
bool has_pose2sim_session(const std::filesystem::path& folder);
Rig read_pose2sim_rig(const std::filesystem::path& folder, Split split);

// Qualisys Track Manager: Calib.qca.txt (XML), beside the videos of its video cameras, which are named by their serial
// numbers; where no camera's name is that of a video, as with Pose2Sim.
bool has_qualisys_files(const std::filesystem::path& folder);
bool has_qualisys_session(const std::filesystem::path& folder);
Rig read_qualisys_rig(const std::filesystem::path& folder, Split split);

// RealityCapture (RealityScan): the table "Internal/External camera parameters", beside images or videos by camera.
bool has_realitycapture_files(const std::filesystem::path& folder);
Rig read_realitycapture_rig(const std::filesystem::path& folder, Split split);

// The app Record3D: metadata, and a folder of images. Every image is a camera of its own, and all of them show one
// frame.
bool has_record3d_files(const std::filesystem::path& folder);
Rig read_record3d_rig(const std::filesystem::path& folder, Split split);

}  // namespace neuvv::training

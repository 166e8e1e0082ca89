#include "tools/data/dataset_files.h"

#include <fmt/format.h>

#include <utility>

#include "base/platform.h"
#include "tools/remedies.h"
#include "tools/report.h"
#include "tools/say.h"
#include "tools/unfinished_folder.h"

namespace neuvv::tools {

void write_as_transforms(training::WriteJob job) {
    const UnfinishedDataset unfinished(job.output, job.dataset);
    const std::filesystem::path output = std::exchange(job.output, unfinished.path());
    catch_stop_signals();
    Progress progress("dataset");
    const training::WriteSummary wrote = training::write_dataset(job, [&](uint64_t done, uint64_t total) {
        progress.set_total(total);
        progress.update(done, "images");
        return done == total || !stop_requested();
    });
    progress.finish();
    if (!wrote.complete) throw RuntimeFailure("stopped before the end; nothing was written");
    unfinished.finish();
    for (const std::string& remark : wrote.remarks) say("{}\n", remark);
    if (!wrote.missing_split.empty())
        say("one split alone was written, the other cannot be read: {}\n", message_of(wrote.missing_split));
    tell("{}: {} images of {} train and {} test cameras, {}, {}\n", output.string(), wrote.images, wrote.train_cameras,
         wrote.test_cameras, wrote.mattes ? "with mattes" : "without mattes",
         wrote.plates > 0 ? fmt::format("{} plates", wrote.plates) : "no plates");
}

}  // namespace neuvv::tools

#include "tools/headset/headset.h"

#include <fmt/format.h>

#include <algorithm>
#include <thread>

#include "editor/draw/device_losses.h"
#include "tools/headset/session_context.h"
#include "tools/headset/sound.h"
#include "tools/options.h"

namespace neuvv::headset {

namespace {

constexpr const char* kWindowTitle = "NeuVV in a headset";

void request_refresh_rate(const Program& program, SessionContext& session) {
    if (!program.options.refresh_hz) return;
    const std::vector<float> rates = session.xr_session.refresh_rates();
    if (rates.empty()) return print_line("the runtime's refresh rate cannot be chosen");
    const auto requested = static_cast<float>(*program.options.refresh_hz);
    const float nearest = *std::min_element(rates.begin(), rates.end(), [&](float a, float b) {
        return std::abs(a - requested) < std::abs(b - requested);
    });
    session.xr_session.request_refresh_rate(nearest);
}

// Returns when the session has ended (kEnded), or is lost so that another one may be begun (kLost).
xr::SessionStatus run_session(Program& program, RuntimeContext& context) {
    SessionContext session(program, context);
    context.make_renderer(program, session.eyes);
    session.actions.update_controllers();
    if (program.window)
        session.mirror =
            std::make_unique<Mirror>(context.device, *program.window, session.eyes.size(), session.panel.image());
    bool exit_requested = false, rate_requested = false;
    for (;;) {
        xr::SessionEvents events;
        events.tracking_change = session.tracking_change;
        const xr::SessionStatus status = session.xr_session.poll(events);
        handle_events(events, program, session);
        if (status == xr::SessionStatus::kEnded || status == xr::SessionStatus::kLost) {
            program.interaction.release_all(program.state);
            stop_sound(program.state, program.sound);
            return status;
        }
        if ((program.leaving || stop_requested()) && !std::exchange(exit_requested, true))
            session.xr_session.request_exit();
        if (status == xr::SessionStatus::kIdle) {
            stop_sound(program.state, program.sound);
            program.jobs.run_posted();
            program.saver->autosave.tick(program.now_s());
            program.notify();
            if (session.mirror && !session.mirror->show(session.eyes.left(), {})) program.leaving = true;
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
            continue;
        }
        if (!std::exchange(rate_requested, true)) request_refresh_rate(program, session);
        frame(program, context, session);
    }
}

// A timeout for retries, which begins anew whenever frames have been drawn.
class RetryLimit {
  public:
    explicit RetryLimit(Program& program) : program_(program), frames_(program.frames) {}
    // To be called after a failure: pauses before the next try, while the window stays alive. Throws RuntimeFailure
    // after the timeout.
    void wait(const std::string& why) {
        if (program_.frames != frames_) from_ = Clock::now();
        has_run_ |= program_.frames != frames_;
        frames_ = program_.frames;
        if (seconds_since(from_) > program_.options.retry_s)
            throw RuntimeFailure(fmt::format("the headset's runtime does not come back: {}", why));
        if (program_.window) program_.window->set_title("NeuVV waits for the headset");
        for (const Clock::time_point from = Clock::now(); seconds_since(from) < kPause_s;) {
            program_.keep_window_alive();
            if (stop_requested() || program_.leaving) return;
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
        if (program_.window) program_.window->set_title(kWindowTitle);
    }
    bool has_run() const { return has_run_ || program_.frames != frames_; }
    // Whether frames were drawn, but none since the last failure: what fails now does so because what was lost has not
    // come back yet.
    bool is_waiting() const { return has_run_ && program_.frames == frames_; }

  private:
    static constexpr double kPause_s = 0.3;
    Program& program_;
    uint64_t frames_;
    bool has_run_ = false;
    Clock::time_point from_ = Clock::now();
};

// Runs sessions on one runtime until the user leaves. Throws XrFailure where the runtime is lost.
void run_sessions(Program& program, RuntimeContext& context) {
    print_line(fmt::format("{}, \"{}\", on {}", context.runtime.name(), context.runtime.headset(),
                           context.device.summary().name));
    if (program.options.quality.inset && context.runtime.has_narrow_views())
        print_line("--inset is not used: this headset has narrow views instead; with --stereo it has none");
    for (RetryLimit retries(program);;) {
        std::string why = "every session ends";
        try {
            if (run_session(program, context) == xr::SessionStatus::kEnded) return;
        } catch (const xr::XrFailure& failure) {
            program.interaction.release_all(program.state);
            const bool may_come = failure.session_lost() || (retries.is_waiting() && !failure.instance_lost());
            if (!may_come || !retries.has_run()) throw;
            why = failure.what();
        }
        context.validation.print();
        if (stop_requested() || program.leaving) return;
        program.state.editor.notify("the headset's session was lost; another one begins");
        program.notify();
        retries.wait(why);
        if (stop_requested() || program.leaving) return;
    }
}

void run_runtimes(Program& program) {
    editor::DeviceLosses losses;
    for (RetryLimit retries(program);;) {
        std::string why;
        bool has_device = false;
        try {
            RuntimeContext context(program);
            has_device = true;
            run_sessions(program, context);
            return;
        } catch (const xr::XrFailure& failure) {
            program.interaction.release_all(program.state);
            const bool is_waiting = retries.is_waiting();
            if (!is_waiting && (!failure.instance_lost() || !retries.has_run())) throw;
            why = failure.what();
            if (!is_waiting)
                print_line(fmt::format("the headset's runtime was lost; waiting for it, {:.0f} s at most",
                                       program.options.retry_s));
        } catch (const gpu::VulkanError& failure) {
            program.interaction.release_all(program.state);
            if (failure.out_of_memory() || !retries.has_run()) throw;
            why = failure.what();
            if (failure.device_lost()) {
                losses.note(why, program.now_s());
                program.state.editor.notify(fmt::format("the device was lost, and is made anew: {}", why), true);
                program.notify();
            }
        } catch (const RuntimeFailure& failure) {
            program.interaction.release_all(program.state);
            if (!retries.has_run()) throw;
            why = failure.what();
        } catch (const InputError& failure) {
            if (has_device || !retries.has_run()) throw;
            why = failure.what();  // while a device is reset, none has the name that the user chose
        }
        if (stop_requested() || program.leaving) return;
        return_freed_memory();  // runtime, device and renderer are gone
        retries.wait(why);
        if (stop_requested() || program.leaving) return;
    }
}

}  // namespace

void run_headset(const HeadsetOptions& options) {
    catch_stop_signals();
    catch_hangup();
    Program program(options);
    program.open();
    if (options.mirror) program.window = std::make_unique<ui::Window>(kWindowTitle, ui::WindowGeometry{});
    const auto save_all = [&] {
        program.finish();
        program.jobs.stop();
        try {
            program.settings.save(program.state, program.interaction.grab.settings);
        } catch (const RuntimeFailure& failure) {
            print_line(failure.what());
        }
        if (program.saver->autosave.store_now())
            print_line(
                fmt::format("unsaved edits are kept: `neuvv xr '{0}' --recover` or `neuvv view '{0}'` takes them",
                            program.opened.string()));
    };
    try {
        run_runtimes(program);
    } catch (...) {
        save_all();
        throw;
    }
    save_all();
    if (!options.report.empty()) write_report(program);
}

}  // namespace neuvv::headset

// A training::Team whose members are threads of the test. They take turns: one runs until it gathers, then the next, so
// that all can use the one Device that a process can have.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "training/team.h"

namespace neuvv::test {

class ThreadTeam {
  public:
    explicit ThreadTeam(uint32_t size) : said_(size) {}

    // Calls `member` once for each member, and returns when all have returned. A member that throws ends the program.
    void run(const std::function<void(const training::Team&)>& member) {
        std::vector<std::thread> threads;
        for (uint32_t rank = 0; rank < said_.size(); rank++)
            threads.emplace_back([this, rank, &member] {
                wait_for_turn(rank);
                member({rank, static_cast<uint32_t>(said_.size()),
                        [this, rank](std::span<const uint8_t> own) { return gather(rank, own); }});
                pass_on();
            });
        for (std::thread& thread : threads) thread.join();
    }

  private:
    std::vector<training::Bytes> gather(uint32_t rank, std::span<const uint8_t> own) {
        said_[rank].assign(own.begin(), own.end());
        pass_on();
        wait_for_turn(rank);
        return heard_;
    }
    void wait_for_turn(uint32_t rank) {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return turn_ == rank; });
    }
    void pass_on() {
        const std::lock_guard lock(mutex_);
        turn_ = (turn_ + 1) % static_cast<uint32_t>(said_.size());
        if (turn_ == 0) heard_ = said_;
        changed_.notify_all();
    }

    std::vector<training::Bytes> said_, heard_;  // in this round of turns; in the round before
    std::mutex mutex_;
    std::condition_variable changed_;
    uint32_t turn_ = 0;
};

inline void run_team(uint32_t size, const std::function<void(const training::Team&)>& member) {
    ThreadTeam(size).run(member);
}

}  // namespace neuvv::test

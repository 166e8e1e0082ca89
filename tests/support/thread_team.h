// A training::Team whose members are threads of the test. They take turns: one runs until it gathers or exchanges, then
// the next, so that all can use the one Device that a process can have.
#pragma once

#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <vector>

#include "training/step/team.h"

namespace neuvv::test {

class ThreadTeam {
  public:
    explicit ThreadTeam(uint32_t size) : said_(size), gathered_(size), ended_(size) {}

    // Calls `member` once for each member, and returns when all have returned. Where one throws, or ends while others
    // still wait for it, all end, and this throws the first exception.
    void run(const std::function<void(const training::Team&)>& member) {
        std::vector<std::thread> threads;
        for (uint32_t rank = 0; rank < said_.size(); ++rank)
            threads.emplace_back([&, rank] { run_member(rank, member); });
        for (std::thread& thread : threads) thread.join();
        if (problem_) std::rethrow_exception(problem_);
    }

  private:
    void run_member(uint32_t rank, const std::function<void(const training::Team&)>& member) {
        wait_for_turn(rank);
        try {
            member({rank, static_cast<uint32_t>(said_.size()),
                    [this, rank](std::span<const uint8_t> own) {
                        say(rank, {training::Bytes(own.begin(), own.end())});
                        return heard(0);
                    },
                    [this, rank](const std::vector<training::Bytes>& to) {
                        say(rank, to);
                        return heard(rank);
                    }});
        } catch (...) {
            if (!problem_) problem_ = std::current_exception();
        }
        ended_[rank] = true;
        pass_on();
    }
    // Returns when all members have said something.
    void say(uint32_t rank, std::vector<training::Bytes> words) {
        said_[rank] = std::move(words);
        ++gathered_[rank];
        pass_on();
        wait_for_turn(rank);
        for (size_t other = 0; other < said_.size(); ++other)
            if (ended_[other] && gathered_[other] < gathered_[rank])
                throw std::logic_error("a member has ended, and another one waits for it");
    }
    // Of what each member said, the bytes with this index.
    std::vector<training::Bytes> heard(uint32_t index) const {
        std::vector<training::Bytes> bytes;
        for (const std::vector<training::Bytes>& words : heard_) bytes.push_back(words.at(index));
        return bytes;
    }
    void wait_for_turn(uint32_t rank) {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return turn_ == rank; });
    }
    // To the next member that has not ended; where all have, nobody waits for the turn.
    void pass_on() {
        const std::lock_guard lock(mutex_);
        const auto size = static_cast<uint32_t>(said_.size());
        for (uint32_t i = 0; i < size; ++i) {
            turn_ = (turn_ + 1) % size;
            if (turn_ == 0) heard_ = said_;
            if (!ended_[turn_]) break;
        }
        changed_.notify_all();
    }

    std::vector<std::vector<training::Bytes>> said_, heard_;  // by member, in this round of turns; in the round before
    std::vector<uint32_t> gathered_;                          // how often, by member
    std::vector<char> ended_;
    std::exception_ptr problem_;
    std::mutex mutex_;
    std::condition_variable changed_;
    uint32_t turn_ = 0;
};

inline void run_team(uint32_t size, const std::function<void(const training::Team&)>& member) {
    ThreadTeam(size).run(member);
}

}  // namespace neuvv::test

#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace busbar::example {

/// Saves what waits some times a second, in a thread of its own: media block.
class MachineSaver {
public:
    /// `save` says whether all is well; after an error it is tried again more slowly.
    explicit MachineSaver(std::function<bool()> save);
    MachineSaver(const MachineSaver&) = delete;
    MachineSaver& operator=(const MachineSaver&) = delete;
    /// Waits for what is being saved.
    ~MachineSaver();

private:
    void work();

    std::function<bool()> save_;
    std::mutex mutex_; // of the two below
    std::condition_variable ends_;
    bool is_ending_{false};
    std::thread thread_;
};

} // namespace busbar::example

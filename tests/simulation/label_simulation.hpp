#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "controller/mapped/label_world.hpp"
#include "label_client.hpp"

namespace busbar::test {

struct LabelSimulationOptions {
    std::uint64_t seed{1};
    std::size_t clients{50};
    SamplingMode sampling{SamplingMode::Standard};
};

/// A simulated PLC whose labels change, the server that maps them, and clients, in virtual time.
/// The same options make the same things happen.
class LabelSimulation {
public:
    explicit LabelSimulation(const LabelSimulationOptions& options);

    /// Labels change and clients do what they like.
    void run(std::chrono::seconds time);
    /// All becomes quiet: then everything has to be as it was written last.
    void finish();

    [[nodiscard]] const Trace& trace() const { return trace_; }
    [[nodiscard]] const std::vector<std::unique_ptr<LabelClient>>& clients() const
    {
        return clients_;
    }
    [[nodiscard]] const ErrorBook& book() const { return plant_.book; }
    [[nodiscard]] int downloads() const { return downloads_; }

private:
    [[nodiscard]] static LabelWorldOptions world_options(const LabelSimulationOptions& options);
    /// The clients' labels in any order among others, and Mode of any type or, unless
    /// `has_mode`, not there.
    [[nodiscard]] std::string variables(bool has_mode);
    void add_nodes();
    void download();

    Chance chance_;
    LabelBoard board_;
    LabelWorld plant_;
    Trace trace_;
    std::vector<std::unique_ptr<LabelClient>> clients_;
    int downloads_{0};
    Alarm download_;
    Alarm scan_end_;
};

} // namespace busbar::test

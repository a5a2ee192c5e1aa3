// The controller of a PLC maker: everything that busbar-controller does, around the maker's runtime
// instead of the simulated PLC. Here the runtime is a tank whose level a task of its own controls;
// variables stay where the runtime has them.
// usage: vendor-runtime --config tank.toml, and all other options of busbar-controller
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

#include <busbar/controller/machine_event_log.hpp>
#include <busbar/net/system.hpp>
#include <busbar/product/program.hpp>
#include <busbar/product/runtime.hpp>

using namespace busbar;
using product::HardwareEvent;

namespace {

/// The memory of the user's program, as tank.st declares it.
struct Tank {
    double level{20.0}; // %
    double set_point{50.0};
    std::uint8_t is_pumping{0};
    std::uint8_t is_leaking{0};
    std::uint8_t has_card{1};    // the contact of the slot for the memory card
    std::uint32_t error_code{0}; // of the highest fault of the controller

    [[nodiscard]] std::span<std::byte> find(std::string_view name)
    {
        const auto bytes = [](auto& value) { return std::as_writable_bytes(std::span{&value, 1}); };
        const std::pair<std::string_view, std::span<std::byte>> all[] = {
            {"Level", bytes(level)},        {"SetPoint", bytes(set_point)},
            {"Pumping", bytes(is_pumping)}, {"Leaking", bytes(is_leaking)},
            {"CardIn", bytes(has_card)},    {"ErrorCode", bytes(error_code)}};
        for (const auto& [each, memory] : all) {
            if (each == name) {
                return memory;
            }
        }
        return {}; // the controller has memory for it
    }
};

/// Each download makes another one.
class TankProgram final : public product::LoadedProgram {
public:
    TankProgram(Tank& tank, product::StorageMedium& card, product::RuntimeHost& host)
        : tank_{tank}, card_{card}, host_{host}
    {
    }
    ~TankProgram() override { TankProgram::stop(); }

    /// Starts the maker's task, here a thread. Without this function the controller's own task
    /// scans.
    bool start(const Cycle& cycle) override
    {
        ends_ = false;
        task_ = std::thread{[this, cycle] { run(cycle); }};
        return true;
    }
    void stop() override
    {
        {
            const std::lock_guard lock{mutex_};
            ends_ = true;
        }
        changed_.notify_all();
        if (task_.joinable()) {
            task_.join();
        }
    }
    /// The memory of the tank has the values that clients wrote before this begins; clients see
    /// its values when this ends.
    void scan(DateTime, Duration elapsed) override
    {
        const double seconds = std::chrono::duration<double>(elapsed).count();
        tank_.is_pumping = tank_.level < tank_.set_point ? 1 : 0;
        tank_.level += seconds * ((tank_.is_pumping != 0 ? 8.0 : 0.0) - 2.0 -
                                  (tank_.is_leaking != 0 ? 4.0 : 0.0));
        tank_.level = std::max(tank_.level, 0.0);
        if (tank_.is_leaking != 0 && !was_leaking_) {
            host_.happen(HardwareEvent::MinorFault);
        }
        was_leaking_ = tank_.is_leaking != 0;
        using State = product::StorageMedium::State;
        card_.set(tank_.has_card != 0 ? State::Usable : State::Away);
        const auto error = host_.plc_error(); // as the instruction GetPLCError
        tank_.error_code = error ? error->code : 0;
    }

private:
    void run(const Cycle& cycle)
    {
        constexpr std::chrono::milliseconds period{10};
        auto next = std::chrono::steady_clock::now();
        std::unique_lock lock{mutex_};
        while (!ends_) {
            lock.unlock();
            cycle(clock_.now(), period);
            lock.lock();
            next += period;
            changed_.wait_until(lock, next, [this] { return ends_; });
        }
    }

    Tank& tank_;
    product::StorageMedium& card_;
    product::RuntimeHost& host_;
    net::SystemWallClock clock_;
    bool was_leaking_{false};
    std::mutex mutex_; // of the flag
    std::condition_variable changed_;
    bool ends_{false};
    std::thread task_;
};

class TankRuntime final : public product::Runtime {
public:
    void begin(product::RuntimeHost& host) override { host_ = &host; }

    [[nodiscard]] std::span<std::byte>
    memory_of(const controller::GlobalVariable& variable) override
    {
        return tank_.find(variable.name);
    }
    [[nodiscard]] Configured<std::unique_ptr<product::LoadedProgram>>
    load(controller::Plc& plc, const controller::Program*) override
    {
        for (const char* const name : {"Level", "SetPoint", "Pumping", "Leaking"}) {
            if (!plc.find(name)) {
                return misconfigured(name,
                                     "the program has no such variable, which the tank needs");
            }
        }
        return std::make_unique<TankProgram>(tank_, card_, *host_);
    }
    /// The memory card, on which the execution log lies. Without lie_in() its files are in the
    /// folder of the configuration.
    [[nodiscard]] product::StorageMedium* medium() override { return &card_; }

private:
    Tank tank_;
    product::StorageMedium card_;
    product::RuntimeHost* host_{nullptr};
};

} // namespace

int main(int argc, char** argv)
{
    TankRuntime runtime;
    return product::run_program(argc, argv, runtime);
}

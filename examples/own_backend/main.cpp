// A backend for a bus of your own on the plan that Busbar's Modbus and SLMP backends share: many
// variables become few telegrams, and an address that the device refuses harms no other one.
// usage: EXAMPLE_PASSWORD=... own-backend [PORT]
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <thread>

#include <busbar/net/bus_source.hpp>
#include <busbar/net/server_app.hpp>
#include <busbar/net/system.hpp>

using namespace busbar;

namespace {

/// An invented bus with a device of 64 cells of 16 bits, of which a telegram carries up to 16. Cell
/// 13 does not exist, and cell 63 counts the telegrams. Replace what is in here with your driver.
class CellBus final : public net::Bus {
public:
    static constexpr std::uint32_t counter = 63;

    [[nodiscard]] backend::PlanConfig plan() const override
    {
        // It costs less to read four cells in vain than to send another telegram.
        backend::PlanConfig config;
        config.rules = {{.max_read = max_cells, .max_write = max_cells, .max_gap = 4}};
        return config;
    }

    Result<std::vector<std::uint16_t>> read(const backend::PlanRequest& telegram) override
    {
        return exchange(telegram).transform(
            [](Cells cells) { return std::vector<std::uint16_t>(cells.begin(), cells.end()); });
    }
    Result<void> write(const backend::PlanRequest& telegram) override
    {
        return exchange(telegram).transform(
            [&](Cells cells) { std::ranges::copy(telegram.words, cells.begin()); });
    }

private:
    static constexpr std::uint32_t max_cells = 16;
    using Cells = std::span<std::uint16_t>;

    /// Sends a telegram, and waits for the device, which refuses what it does not have.
    Result<Cells> exchange(const backend::PlanRequest& telegram)
    {
        constexpr std::uint32_t missing = 13;
        std::this_thread::sleep_for(std::chrono::milliseconds{5});
        ++cells_[counter];
        const backend::PlanAddress& range = telegram.ranges.front();
        const std::uint32_t end = range.offset + range.width;
        if (end > cells_.size() || (range.offset <= missing && missing < end)) {
            return fail(status::Bad_ConfigurationError);
        }
        return std::span{cells_}.subspan(range.offset, range.width);
    }

    std::array<std::uint16_t, 64> cells_{};
};

} // namespace

int main(int argc, char** argv)
{
    const std::string port = argc > 1 ? argv[1] : "4840";
    net::StderrLog log;
    net::ServerApp app{{"urn:example:own-backend", "Own backend", "server_pki"},
                       "opc.tcp://localhost:" + port};
    app.add_user("operator", std::getenv("EXAMPLE_PASSWORD"));
    std::vector<backend::DevicePoint> points; // the handle of a variable is the number of its cell
    for (std::uint32_t cell = 0; cell <= CellBus::counter; ++cell) {
        points.push_back({.address = {.offset = cell}, .is_writable = cell != CellBus::counter});
    }
    const auto& source = app.make_source<net::BusSource>(std::make_unique<CellBus>(), points,
                                                         net::BusSourceOptions{.log = &log});
    const std::uint16_t cells = app.add_namespace("urn:example:cells");
    for (std::uint32_t cell = 0; cell < CellBus::counter; ++cell) {
        app.add_variable({cells, "Cell" + std::to_string(cell)},
                         source.variable(cell, std::uint16_t{0}), model::Access::ReadWrite);
    }
    app.add_variable({cells, "Telegrams"}, source.variable(CellBus::counter, std::uint16_t{0}));
    return app.run();
}

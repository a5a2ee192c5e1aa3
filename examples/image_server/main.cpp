// A server for the variables of a PLC task, which publishes them once a scan and never waits.
// usage: EXAMPLE_PASSWORD=... image-server [PORT]
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <thread>

#include <busbar/net/server_app.hpp>
#include <busbar/net/system.hpp>
#include <busbar/server/process_image.hpp>

using namespace busbar;

namespace {

/// Names the variables of the task, and says where they lie.
struct Layout {
    server::ImageLayout layout;
    std::uint32_t parts = add({BuiltInType::UInt32});
    std::uint32_t set_point = add({BuiltInType::Double});
    std::uint32_t positions = add({BuiltInType::Double, {4}});
    std::uint32_t recipe = add({BuiltInType::String, {}, 32});

    std::uint32_t add(const server::ImageVariable& variable)
    {
        return layout.add(variable).value(); // refused: a type or size that no image can have
    }
};

/// One scan every 10 ms, on a thread of its own.
class Task {
public:
    Task(std::shared_ptr<server::ProcessImage> image, const Layout& places)
        : image_{std::move(image)}, places_{places}, thread_{[this] { run(); }}
    {
    }
    ~Task()
    {
        ends_ = true;
        thread_.join();
    }

private:
    void run()
    {
        server::ImageMemory& memory = image_->memory();
        std::uint32_t& parts = memory.value<std::uint32_t>(places_.parts);
        double& set_point = memory.value<double>(places_.set_point);
        const std::span<double> positions = memory.values<double>(places_.positions);
        memory.set_text(places_.recipe, "cover plate");
        set_point = 100;
        auto next = std::chrono::steady_clock::now();
        for (double angle = 0; !ends_; angle += 0.01) {
            image_->begin_scan(); // what clients have written is in memory now
            ++parts;
            for (double& position : positions) {
                position = set_point * std::sin(angle);
            }
            image_->publish(clock_.now()); // what clients see from now on
            next += std::chrono::milliseconds{10};
            std::this_thread::sleep_until(next);
        }
        image_->halt();
    }

    std::shared_ptr<server::ProcessImage> image_;
    Layout places_;
    net::SystemWallClock clock_;
    std::atomic<bool> ends_{false};
    std::thread thread_;
};

} // namespace

// NOLINTNEXTLINE(bugprone-exception-escape): without memory or threads an example ends
int main(int argc, char** argv)
{
    const std::string port = argc > 1 ? argv[1] : "4840";
    net::ServerApp app{{"urn:example:image-server", "Image server", "server_pki"},
                       "opc.tcp://localhost:" + port};
    app.add_user("operator", std::getenv("EXAMPLE_PASSWORD"));
    const std::uint16_t press = app.add_namespace("urn:example:press");

    const Layout places;
    const auto image = server::ProcessImage::create(places.layout);
    const auto& source = app.make_source<server::ImageSource>(image);
    app.add_variable({press, "Parts"}, source.variable(places.parts, std::uint32_t{0}));
    app.add_variable({press, "SetPoint"}, source.variable(places.set_point, 0.0),
                     model::Access::ReadWrite);
    app.add_variable({press, "Positions"},
                     source.variable(places.positions, Array<double>{0, 0, 0, 0}));
    app.add_variable({press, "Recipe"}, source.variable(places.recipe, String{""}),
                     model::Access::ReadWrite);
    const Task task{image, places};
    return app.run();
}

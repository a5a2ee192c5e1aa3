// A server whose values come from a bus that answers later, on a thread of its own.
// usage: EXAMPLE_PASSWORD=... bus-server [PORT]
#include <array>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>
#include <variant>

#include <busbar/net/server_app.hpp>

using namespace busbar;

namespace {

/// A bus with two registers. The server's thread only queues requests; the bus's thread answers
/// each of them, one telegram after the other.
class Bus final : public server::DataSource {
public:
    static constexpr std::uint64_t level = 0;
    static constexpr std::uint64_t set_point = 1;

    Bus() : thread_{[this] { run(); }} {}
    ~Bus() override
    {
        {
            const std::lock_guard lock{mutex_};
            ends_ = true;
        }
        changed_.notify_one();
        thread_.join();
    }

    void read(server::ReadBatch batch) override { queue(std::move(batch)); }
    void write(server::WriteBatch batch) override { queue(std::move(batch)); }
    /// A PLC that is slow needs more than the 5 s that a batch may take by default.
    [[nodiscard]] server::DataSourceOptions options() const override
    {
        return {.timeout = std::chrono::seconds{10}};
    }

private:
    using Batch = std::variant<server::ReadBatch, server::WriteBatch>;

    void queue(Batch batch)
    {
        {
            const std::lock_guard lock{mutex_};
            waiting_.push_back(std::move(batch));
        }
        changed_.notify_one();
    }
    /// The next batch, or nothing at the end.
    std::optional<Batch> next()
    {
        std::unique_lock lock{mutex_};
        changed_.wait(lock, [this] { return ends_ || !waiting_.empty(); });
        if (ends_) {
            return std::nullopt; // what still waits answers Bad_NoCommunication
        }
        Batch batch = std::move(waiting_.front());
        waiting_.pop_front();
        return batch;
    }
    void run()
    {
        while (auto batch = next()) {
            std::this_thread::sleep_for(std::chrono::milliseconds{20}); // the telegram
            std::visit([this](auto& each) { answer(each); }, *batch);
        }
    }
    void answer(server::ReadBatch& batch)
    {
        for (std::size_t i = 0; i < batch.size(); ++i) {
            batch.results()[i] = DataValue{registers_.at(batch.items()[i].handle)};
        }
        batch.complete();
    }
    void answer(server::WriteBatch& batch)
    {
        for (std::size_t i = 0; i < batch.size(); ++i) {
            const server::WriteItem& item = batch.items()[i];
            const double value = item.data->value.value_or<double>(-1);
            const bool is_in_range = value >= 0 && value <= 100;
            batch.results()[i] = is_in_range ? status::Good : status::Bad_OutOfRange;
            if (is_in_range) {
                registers_.at(item.handle) = value;
            }
        }
        batch.complete();
    }

    std::array<double, 2> registers_{20.0, 50.0}; // used by the bus's thread only
    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<Batch> waiting_;
    bool ends_{false};
    std::thread thread_;
};

} // namespace

int main(int argc, char** argv)
{
    const std::string port = argc > 1 ? argv[1] : "4840";
    net::ServerApp app{{"urn:example:bus-server", "Bus server", "server_pki"},
                       "opc.tcp://localhost:" + port};
    app.add_user("operator", std::getenv("EXAMPLE_PASSWORD"));
    const std::uint16_t tank = app.add_namespace("urn:example:tank");
    Bus& bus = app.make_source<Bus>();
    app.add_variable({tank, "Level"}, bus.variable(Bus::level, 0.0));
    app.add_variable({tank, "SetPoint"}, bus.variable(Bus::set_point, 0.0),
                     model::Access::ReadWrite);
    return app.run();
}

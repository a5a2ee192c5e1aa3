// A backend for a bus of your own on the plan that Busbar's Modbus and SLMP backends share: many
// variables become few telegrams, and an address that the device refuses harms no other one.
// usage: EXAMPLE_PASSWORD=... own-backend [PORT]
#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <deque>
#include <map>
#include <mutex>
#include <thread>
#include <variant>

#include <busbar/backend/plan.hpp>
#include <busbar/net/server_app.hpp>

using namespace busbar;

namespace {

/// The device at the other end, and the bus: replace it with yours. It has 64 cells of 16 bits, of
/// which a telegram carries up to 16. Cell 13 does not exist, and cell 63 counts the telegrams.
class CellBus {
public:
    static constexpr std::uint32_t max_cells = 16;
    static constexpr std::uint32_t counter = 63;

    /// Returns the cells, or none if the device refuses the telegram.
    std::vector<std::uint16_t> read(std::uint32_t first, std::uint32_t count)
    {
        if (!exchange(first, count)) {
            return {};
        }
        const auto begin = cells_.begin() + first;
        return {begin, begin + count};
    }
    bool write(std::uint32_t first, const std::vector<std::uint16_t>& words)
    {
        const bool is_taken = exchange(first, static_cast<std::uint32_t>(words.size()));
        if (is_taken) {
            std::copy(words.begin(), words.end(), cells_.begin() + first);
        }
        return is_taken;
    }

private:
    bool exchange(std::uint32_t first, std::uint32_t count)
    {
        constexpr std::uint32_t missing = 13;
        std::this_thread::sleep_for(std::chrono::milliseconds{5});
        ++cells_[counter];
        const bool has_missing = first <= missing && missing < first + count;
        return count <= max_cells && first + count <= cells_.size() && !has_missing;
    }

    std::array<std::uint16_t, 64> cells_{};
};

/// Serves cells; the handle of a variable is the number of its cell. The server's thread only
/// queues batches, and a thread of its own speaks to the bus.
class CellSource final : public server::DataSource {
public:
    CellSource() : thread_{[this] { run(); }} {}
    ~CellSource() override
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

private:
    using Batch = std::variant<server::ReadBatch, server::WriteBatch>;

    static backend::PlanConfig rules()
    {
        // It costs less to read four cells in vain than to send another telegram.
        backend::PlanConfig config;
        config.rules = {
            {.max_read = CellBus::max_cells, .max_write = CellBus::max_cells, .max_gap = 4}};
        return config;
    }
    static TimePoint now() { return std::chrono::steady_clock::now(); }
    static backend::PlanAddress address_of(std::uint64_t handle)
    {
        return {.offset = static_cast<std::uint32_t>(handle)};
    }

    void queue(Batch batch)
    {
        {
            const std::lock_guard lock{mutex_};
            waiting_.push_back(std::move(batch));
        }
        changed_.notify_one();
    }
    void run()
    {
        std::unique_lock lock{mutex_};
        while (!ends_) { // what still waits at the end answers Bad_NoCommunication
            std::deque<Batch> batches = std::exchange(waiting_, {});
            lock.unlock();
            for (Batch& batch : batches) {
                std::visit([this](auto& each) { begin(each); }, batch);
            }
            while (const auto request = plan_.next_request()) {
                send(*request);
                finish_batches();
            }
            finish_batches();
            lock.lock();
            changed_.wait(lock, [this] { return ends_ || !waiting_.empty(); });
        }
    }
    void begin(server::ReadBatch& batch)
    {
        std::vector<backend::PlanAddress> addresses;
        for (const server::ReadItem& item : batch.items()) {
            addresses.push_back(address_of(item.handle));
        }
        if (const auto number = plan_.read(addresses, now())) {
            open_.emplace(*number, std::move(batch));
        }
    }
    void begin(server::WriteBatch& batch)
    {
        std::vector<std::uint16_t> words;
        for (const server::WriteItem& item : batch.items()) {
            words.push_back(item.data->value.value_or<std::uint16_t>(0));
        }
        std::vector<backend::PlanWrite> writes;
        for (std::size_t i = 0; i < words.size(); ++i) {
            writes.push_back({address_of(batch.items()[i].handle), {&words[i], 1}});
        }
        if (const auto number = plan_.write(writes)) {
            open_.emplace(*number, std::move(batch));
        }
    }
    /// One request of the plan is one telegram.
    void send(const backend::PlanRequest& request)
    {
        const backend::PlanAddress& cells = request.ranges.front();
        const std::vector<std::uint16_t> words =
            request.is_write ? std::vector<std::uint16_t>{} : bus_.read(cells.offset, cells.width);
        if (request.is_write ? bus_.write(cells.offset, request.words) : !words.empty()) {
            plan_.answer(request.id, words, now());
        } else {
            plan_.refuse(request.id, status::Bad_ConfigurationError, now());
        }
    }
    void finish_batches()
    {
        while (const auto result = plan_.next_result()) {
            auto batch = open_.extract(result->batch);
            std::visit([&](auto& each) { finish(each, *result); }, batch.mapped());
        }
    }
    static void finish(server::ReadBatch& batch, const backend::PlanResult& result)
    {
        for (std::size_t i = 0; i < batch.size(); ++i) {
            const backend::PlanValue& value = result.values[i];
            batch.results()[i] = value.status.is_good() ? DataValue{result.words_of(value).front()}
                                                        : DataValue{value.status};
        }
        batch.complete();
    }
    static void finish(server::WriteBatch& batch, const backend::PlanResult& result)
    {
        for (std::size_t i = 0; i < batch.size(); ++i) {
            batch.results()[i] = result.values[i].status;
        }
        batch.complete();
    }

    // Used by the bus's thread only.
    CellBus bus_;
    backend::RequestPlan plan_{rules()};
    std::map<std::uint64_t, Batch> open_;

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
    net::ServerApp app{{"urn:example:own-backend", "Own backend", "server_pki"},
                       "opc.tcp://localhost:" + port};
    app.add_user("operator", std::getenv("EXAMPLE_PASSWORD"));
    const std::uint16_t cells = app.add_namespace("urn:example:cells");
    auto& source = app.make_source<CellSource>();
    for (std::uint32_t cell = 0; cell < CellBus::counter; ++cell) {
        app.add_variable({cells, "Cell" + std::to_string(cell)},
                         source.variable(cell, std::uint16_t{0}), model::Access::ReadWrite);
    }
    app.add_variable({cells, "Telegrams"}, source.variable(CellBus::counter, std::uint16_t{0}));
    return app.run();
}

// What it costs that a Write of RETAIN variables outlasts the end of the program: Writes through a
// server, in turn of variables that are RETAIN and of others, each answered after a scan.

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

#include <busbar/client/connection.hpp>
#include <busbar/controller/program_image.hpp>
#include <busbar/controller/program_types.hpp>
#include <busbar/controller/retained_values.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/server/password_users.hpp>
#include <busbar/server/process_image.hpp>
#include <busbar/server/server.hpp>
#include <busbar/storage/folder_storage.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/ids.hpp>

#include "command_line/program_options.hpp"

using namespace busbar;

namespace {

constexpr std::uint32_t variable_count = 1'000;   // of each kind
constexpr std::uint32_t values_of_round = 20'000; // in at most 1,000 Writes
constexpr int rounds = 5;

[[noreturn]] void give_up(std::string_view why)
{
    std::fprintf(stderr, "busbar-retained-bench: %s\n", std::string{why}.c_str());
    std::exit(1);
}

template <typename T>
T expect(Result<T> result)
{
    if (!result) {
        give_up(name(result.error()));
    }
    return *std::move(result);
}

template <typename T>
T expect(Configured<T> made)
{
    if (!made) {
        give_up(text(made.error()));
    }
    return *std::move(made);
}

class FixedClock final : public WallClock {
public:
    [[nodiscard]] DateTime now() const override
    {
        return DateTime::from_unix_seconds(1'800'000'000);
    }
};

/// The first half is RETAIN.
controller::Program make_program()
{
    controller::Program program;
    for (std::uint32_t i = 0; i < 2 * variable_count; ++i) {
        program.variables.push_back({.name = "Station_" + std::to_string(i) + "_Setpoint",
                                     .type = {.elementary = controller::ElementaryType::Dint},
                                     .is_retained = i < variable_count});
    }
    return program;
}

controller::ProgramImage make_image(const controller::ProgramTypes& types)
{
    std::vector<std::size_t> all(2 * variable_count);
    std::iota(all.begin(), all.end(), std::size_t{0});
    auto image = controller::ProgramImage::create(types, all, [](const controller::DerivedType&) {
        return NodeId{1, 1};
    });
    if (!image) {
        give_up(text(image.error()));
    }
    return *std::move(image);
}

class Log final : public server::ImageWriteLog {
public:
    explicit Log(controller::RetainedValues& values) : values_{values} {}
    bool keeps(const server::ProcessImage&, std::uint32_t handle) const override
    {
        return values_.keeps(handle);
    }
    StatusCode keep(const server::ProcessImage&,
                    std::span<const server::ImageWrite> writes) override
    {
        return values_.keep(writes) ? status::Good : status::Bad_ResourceUnavailable;
    }

private:
    controller::RetainedValues& values_;
};

double now_us()
{
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) * 1e6 + static_cast<double>(time.tv_nsec) / 1e3;
}

class Bench {
public:
    explicit Bench(Storage& storage)
        : program_{make_program()}, types_{expect(controller::ProgramTypes::create(program_))},
          image_{make_image(types_)}, retained_{storage, types_, image_}, log_{retained_}
    {
        source_.emplace(image_.image());
        source_->keep_writes(&log_);
        users_.set_anonymous_access(0xFF);
        server::ServerConfig config;
        config.endpoints.clear();
        config.endpoints.emplace_back().allows_anonymous = true;
        config.endpoints.back().allows_user_name = false;
        server_.emplace(expect(server::Server::create(std::move(config), environment())));
        const std::uint32_t index = server_->add_source(*source_);
        for (std::uint32_t i = 0; i < 2 * variable_count; ++i) {
            model::NewNode node;
            node.id = NodeId{1, i};
            node.browse_name = QualifiedName{1, String{"V" + std::to_string(i)}};
            node.parent = server_->address_space().find(id::ObjectsFolder);
            model::NewVariable variable;
            variable.data_type = NodeId{0, id::Int32};
            variable.access_level = model::Access::ReadWrite;
            variable.source = index;
            variable.handle = i;
            expect(server_->address_space().add_variable(node, std::move(variable)));
        }
        open();
    }

    /// Processor time of the server for one Write of so many values, in microseconds.
    double round(std::uint32_t items, bool is_retained)
    {
        spent_ = 0;
        const std::uint32_t count = std::min(values_of_round / items, 1'000U);
        for (std::uint32_t i = 0; i < count; ++i) {
            WriteRequest request;
            request.nodes_to_write.resize(items);
            for (std::uint32_t k = 0; k < items; ++k) {
                WriteValue& each = request.nodes_to_write[k];
                each.node_id = NodeId{1, (is_retained ? 0 : variable_count) + k};
                each.attribute_id = 13;
                each.value = DataValue{Variant{static_cast<std::int32_t>(++value_)}};
            }
            static_cast<void>(expect(client_->send(request)));
            const auto response = expect(wait().response<WriteResponse>());
            if (!std::ranges::all_of(response.results,
                                     [](StatusCode each) { return each.is_good(); })) {
                give_up("a Write was refused");
            }
        }
        if (!retained_.save()) { // as the controller does now and then, on another thread
            give_up("the values cannot be saved");
        }
        return spent_ / count;
    }

private:
    [[nodiscard]] server::ServerEnvironment environment()
    {
        return {.random = &random_, .wall_clock = &clock_, .log = &lines_, .users = &users_};
    }
    void open()
    {
        connection_.emplace(expect(server_->connect("192.0.2.1", now_)));
        client::ConnectionConfig wishes;
        wishes.channel.endpoint_url = "opc.tcp://localhost:4840";
        client_.emplace(
            std::move(wishes),
            channel::ChannelEnvironment{.random = &random_, .wall_clock = &clock_, .log = &lines_},
            now_);
        scan();
        if (const auto ready = wait(); ready.kind != client::ConnectionEvent::Kind::Ready) {
            give_up(name(ready.status));
        }
    }
    void scan()
    {
        image_.image()->begin_scan();
        image_.image()->publish(clock_.now());
    }
    client::ConnectionEvent wait()
    {
        for (int i = 0; i < 1'000; ++i) {
            if (auto event = client_->next_event()) {
                return *std::move(event);
            }
            const std::vector<std::byte> request{client_->output().begin(),
                                                 client_->output().end()};
            client_->consume(request.size());
            const double begin = now_us();
            static_cast<void>(connection_->feed(request, now_));
            while (connection_->next_deadline() <= now_) {
                connection_->handle_deadline(now_);
            }
            const double fed = now_us();
            scan();
            const double scanned = now_us();
            server_->handle_completions(now_);
            spent_ += (fed - begin) + (now_us() - scanned);
            static_cast<void>(client_->feed(connection_->output(), now_));
            connection_->consume(connection_->output().size());
        }
        give_up("no answer");
    }

    FixedClock clock_;
    crypto::SystemRandom random_;
    NullLog lines_;
    server::PasswordUsers users_;
    TimePoint now_{};
    controller::Program program_;
    controller::ProgramTypes types_;
    controller::ProgramImage image_;
    controller::RetainedValues retained_;
    Log log_;
    std::optional<server::ImageSource> source_;
    std::optional<server::Server> server_;
    std::optional<server::Connection> connection_;
    std::optional<client::Connection> client_;
    double spent_{0};
    std::uint32_t value_{0};
};

double median(std::vector<double> all)
{
    std::ranges::sort(all);
    return all[all.size() / 2];
}

} // namespace

int main(int argc, char** argv)
{
    std::string folder = "retained-bench";
    CLI::App app{"Measures what it costs that a Write of RETAIN variables outlasts the end of the "
                 "program: Writes of these and of others in turn, each answered after a scan."};
    app.add_option("folder", folder, "is made, on the medium that is to be measured")
        ->capture_default_str();
    command_line::add_program_options(app, "busbar-retained-bench");
    CLI11_PARSE(app, argc, argv);
    storage::FolderStorage storage{folder};
    if (!storage.make_folder("", FileAccess::Owner)) {
        give_up("the folder cannot be made");
    }
    Bench bench{storage};
    std::printf("%8s %16s %16s %8s\n", "values", "Writes/s plain", "RETAIN", "time");
    for (const std::uint32_t items : {1U, 10U, 100U, variable_count}) {
        std::vector<double> plain;
        std::vector<double> retained;
        std::vector<double> ratios;
        for (int i = 0; i < rounds; ++i) {
            plain.push_back(bench.round(items, false));
            retained.push_back(bench.round(items, true));
            ratios.push_back(retained.back() / plain.back());
        }
        std::printf("%8u %16.0f %16.0f %7.2fx\n", items, 1e6 / median(plain),
                    1e6 / median(retained), median(ratios));
        std::fflush(stdout);
    }
    return 0;
}

#include <catch2/catch.hpp>

#include <condition_variable>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <busbar/backend/label_backend.hpp>
#include <busbar/controller/machine_event_log.hpp>
#include <busbar/controller/machine_settings.hpp>
#include <busbar/controller/published_program.hpp>
#include <busbar/controller/simulated_labels.hpp>
#include <busbar/core/log.hpp>
#include <busbar/product/controller.hpp>
#include <busbar/storage/folder_storage.hpp>

#include "product/store/received_program.hpp"
#include "support/temporary_folder.hpp"

namespace runtime_test {

using namespace busbar;
using namespace busbar::product;
using namespace std::chrono_literals;

namespace {

/// What a runtime was asked for, in order. Any thread.
class Story {
public:
    void add(std::string what)
    {
        const std::lock_guard lock{mutex_};
        all_.push_back(std::move(what));
        changed_.notify_all();
    }
    void wait_for(const std::string& what)
    {
        std::unique_lock lock{mutex_};
        changed_.wait(lock, [&] { return std::ranges::count(all_, what) > 0; });
    }
    [[nodiscard]] std::vector<std::string> all() const
    {
        const std::lock_guard lock{mutex_};
        return all_;
    }

private:
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<std::string> all_;
};

/// Holds whoever loads a program, until it is opened. Any thread.
class Gate {
public:
    void close()
    {
        const std::lock_guard lock{mutex_};
        is_open_ = false;
    }
    void open()
    {
        const std::lock_guard lock{mutex_};
        is_open_ = true;
        changed_.notify_all();
    }
    void pass()
    {
        std::unique_lock lock{mutex_};
        is_asked_ = !is_open_;
        changed_.notify_all();
        changed_.wait(lock, [&] { return is_open_; });
    }
    void wait_until_asked()
    {
        std::unique_lock lock{mutex_};
        changed_.wait(lock, [&] { return is_asked_; });
    }

private:
    std::mutex mutex_;
    std::condition_variable changed_;
    bool is_open_{true};
    bool is_asked_{false};
};

class ToldProgram final : public LoadedProgram {
public:
    ToldProgram(Story& story, bool has_task, double& level)
        : story_{story}, has_task_{has_task}, level_{level}
    {
    }
    ~ToldProgram() override { story_.add("unloaded"); }

    bool start(const Cycle& cycle) override
    {
        story_.add("started");
        if (has_task_) {
            cycle(DateTime::from_unix_seconds(1'000), 10ms);
        }
        return has_task_;
    }
    void stop() override { story_.add("stopped"); }
    void edited(const controller::ProgramAddition& change) override
    {
        story_.add("edited: " + std::to_string(change.image.variables.size()) + " more, " +
                   std::to_string(change.removed.size()) + " less");
    }
    void scan(DateTime, Duration) override
    {
        level_ += 1;
        if (!std::exchange(has_scanned_, true)) {
            story_.add("scanned");
        }
    }

private:
    Story& story_;
    bool has_task_;
    double& level_;
    bool has_scanned_{false};
};

class ToldRuntime final : public Runtime {
public:
    void begin(RuntimeHost& host) override
    {
        host_ = &host;
        story.add("begin");
    }
    void end() override { story.add("end"); }
    std::span<std::byte> memory_of(const controller::GlobalVariable& variable) override
    {
        return variable.name == "Level" ? std::as_writable_bytes(std::span{&level, 1})
                                        : std::span<std::byte>{};
    }
    Configured<std::unique_ptr<LoadedProgram>> load(controller::Plc& plc,
                                                    const controller::Program* program) override
    {
        if (!plc.find("Level")) {
            return misconfigured("Level", "there is none");
        }
        loads.pass();
        story.add(program != nullptr ? "loaded " + program->variables.front().name : "loaded");
        return std::make_unique<ToldProgram>(story, has_task, level);
    }

    void mode_changed(controller::MachineMode mode) override
    {
        story.add(mode == controller::MachineMode::Run ? "RUN" : "PROGRAM");
    }

    std::shared_ptr<backend::LabelBackend> labels() override { return all_labels; }
    StorageMedium* medium() override { return &card; }

    Story story;
    Gate loads;
    std::shared_ptr<backend::LabelBackend> all_labels;
    RuntimeHost* host_{nullptr};
    StorageMedium card;
    bool has_task{false};
    double level{41};
};

/// A folder with a configuration that anybody may use at this machine.
struct Place {
    [[nodiscard]] std::string path(const std::string& in) const
    {
        return (folder.path / in).string();
    }
    void program(const std::string& variables) const
    {
        std::ofstream{path("p.st")} << "{attribute 'publish' := 'publish only'}\nVAR_GLOBAL\n"
                                    << variables << "\nEND_VAR\n";
    }
    [[nodiscard]] Configuration file(const std::string& name, const std::string& more,
                                     const std::string& server = {}) const
    {
        program("Level : LREAL; Other : INT;");
        std::ofstream{path(name)} << "[server]\naddress = \"127.0.0.1\"\nport = 0\n"
                                  << server << "[certificates]\nfolder = \"" << path("pki")
                                  << "\"\n[users]\nanonymous = \"write\"\n"
                                     "[[endpoint]]\npolicy = \"None\"\nmode = \"None\"\n"
                                  << more;
        return {.file = path(name)};
    }
    [[nodiscard]] std::string machine() const
    {
        return "[machine]\nprogram = \"" + path("p.st") + "\"\nstate = \"" + path("state") +
               "\"\nmedium = \"" + path("medium") + "\"\n";
    }

    test::TemporaryFolder folder;
    NullLog log;
    ControllerOptions options{.log = &log, .takes_signals = false, .greets = false};
};

/// Holds the thread that loads information models, until it may go on. Any thread.
class HeldLog final : public LogSink {
public:
    void write(LogLevel, std::string_view source, std::string_view message) override
    {
        std::unique_lock lock{mutex_};
        messages_.emplace_back(message);
        if (source == "model") {
            ++loads_;
            changed_.notify_all();
            changed_.wait(lock, [&] { return may_load_ >= loads_; });
        }
        changed_.notify_all();
    }
    void wait_for_load(int number)
    {
        std::unique_lock lock{mutex_};
        changed_.wait(lock, [&] { return loads_ >= number; });
    }
    void let_load(int number)
    {
        const std::lock_guard lock{mutex_};
        may_load_ = number;
        changed_.notify_all();
    }
    void wait_for_message(std::string_view start)
    {
        std::unique_lock lock{mutex_};
        changed_.wait(lock, [&] {
            return std::ranges::any_of(messages_,
                                       [&](const auto& one) { return one.starts_with(start); });
        });
    }

private:
    std::mutex mutex_;
    std::condition_variable changed_;
    int loads_{0};
    int may_load_{1};
    std::vector<std::string> messages_;
};

constexpr const char* empty_model =
    R"(<UANodeSet xmlns="http://opcfoundation.org/UA/2011/03/UANodeSet.xsd"><NamespaceUris>
<Uri>urn:test:model</Uri></NamespaceUris><Models><Model ModelUri="urn:test:model"/></Models>
<UAObject NodeId="ns=1;i=1" BrowseName="1:Box"><References>
<Reference ReferenceType="i=35" IsForward="false">i=85</Reference>
<Reference ReferenceType="i=40">i=58</Reference></References></UAObject></UANodeSet>)";

} // namespace

TEST_CASE("while a program is made ready the other one is served, and what is changed counts")
{
    Place place;
    HeldLog log;
    place.options.log = &log;
    std::ofstream{place.path("m.xml")} << empty_model;
    ToldRuntime runtime;
    auto controller =
        Controller::create(place.file("c.toml", place.machine() + "mode = \"PROGRAM\"\n",
                                      "nodesets = [\"" + place.path("m.xml") + "\"]\n"),
                           runtime, place.options);
    REQUIRE(controller);
    std::thread serving{[&] { CHECK((*controller)->run()); }};
    runtime.story.wait_for("scanned");

    place.program("Level : LREAL; Other : REAL;");
    runtime.host_->reload();
    log.wait_for_load(2);
    runtime.host_->happen(HardwareEvent::MinorFault);
    while (!runtime.host_->plc_error()) {
        std::this_thread::yield(); // the server's thread comes to it
    }
    // Of a user list that was changed meanwhile another one is made.
    storage::FolderStorage folder{place.path("pki")};
    const std::string_view users = R"({"version":1,"users":[]})";
    REQUIRE(folder.replace("users.json", std::as_bytes(std::span{users}), FileAccess::Owner));
    log.let_load(2);
    log.wait_for_load(3);
    runtime.story.wait_for("unloaded"); // the one before that, which was never started
    CHECK(std::ranges::count(runtime.story.all(), "started") == 1);
    log.let_load(3);
    log.wait_for_message("downloaded: ");
    (*controller)->stop();
    serving.join();
    const auto all = runtime.story.all();
    CHECK(std::ranges::count(all, "loaded Level") == 3);
    CHECK(std::ranges::count(all, "started") == 2);
}

TEST_CASE("a program that loads for long is waited for by no client")
{
    Place place;
    ToldRuntime runtime;
    auto controller = Controller::create(
        place.file("c.toml", place.machine() + "mode = \"PROGRAM\"\n"), runtime, place.options);
    REQUIRE(controller);
    std::thread serving{[&] { CHECK((*controller)->run()); }};
    runtime.story.wait_for("scanned");
    runtime.loads.close();
    place.program("Level : LREAL; Other : REAL;");
    runtime.host_->reload();
    runtime.loads.wait_until_asked();
    // The server's thread does what it is asked for meanwhile.
    runtime.host_->happen(HardwareEvent::MinorFault);
    while (!runtime.host_->plc_error()) {
        std::this_thread::yield();
    }
    runtime.loads.open();
    runtime.story.wait_for("unloaded");
    (*controller)->stop();
    serving.join();
    CHECK(std::ranges::count(runtime.story.all(), "loaded Level") == 2);
}

TEST_CASE("a runtime's program runs in the controller's task, in the runtime's memory")
{
    Place place;
    ToldRuntime runtime;
    {
        auto controller =
            Controller::create(place.file("c.toml", place.machine()), runtime, place.options);
        REQUIRE(controller);
        std::thread serving{[&] { CHECK((*controller)->run()); }};
        runtime.story.wait_for("scanned");
        CHECK_FALSE(runtime.host_->plc_error());
        place.program("Level : LREAL; Third : INT; Fourth : INT;");
        runtime.host_->reload();
        runtime.story.wait_for("edited: 2 more, 1 less");
        runtime.host_->switch_mode(controller::MachineMode::Program);
        runtime.story.wait_for("PROGRAM");
        (*controller)->stop();
        serving.join();
    }
    CHECK(runtime.story.all() == std::vector<std::string>{"begin", "loaded Level", "RUN", "started",
                                                          "scanned", "edited: 2 more, 1 less",
                                                          "PROGRAM", "unloaded", "end"});
    CHECK(runtime.level > 41);
}

TEST_CASE("the execution log lies where a runtime's card is, and waits for it")
{
    constexpr const char* log_folder = "card/packages/OPCUA_Server/ExecutionLog";
    Place place;
    ToldRuntime runtime;
    runtime.card.lie_in(place.path("card"));
    runtime.card.set(StorageMedium::State::Away);
    std::filesystem::create_directory(place.path("card"));
    auto controller = Controller::create(
        place.file("c.toml", place.machine() + "execution_log = true\n"), runtime, place.options);
    REQUIRE(controller);
    std::thread serving{[&] { CHECK((*controller)->run()); }};
    runtime.story.wait_for("scanned");
    const auto has_log = [&] { return std::filesystem::exists(place.path(log_folder)); };
    CHECK_FALSE(has_log());
    runtime.card.set(StorageMedium::State::Usable);
    while (!has_log()) {
        std::this_thread::yield();
    }
    CHECK_FALSE(std::filesystem::exists(place.path("medium")));
    (*controller)->stop();
    serving.join();
}

TEST_CASE("a runtime's own task scans instead of the controller's and is stopped with it")
{
    Place place;
    ToldRuntime runtime;
    runtime.has_task = true;
    {
        auto controller =
            Controller::create(place.file("c.toml", place.machine()), runtime, place.options);
        REQUIRE(controller);
        (*controller)->stop(); // before run(), which ends at once then
        CHECK((*controller)->run());
    }
    CHECK(runtime.story.all() == std::vector<std::string>{"begin", "loaded Level", "RUN", "started",
                                                          "scanned", "stopped", "unloaded", "end"});
    CHECK(runtime.level == 42);
}

TEST_CASE("what a runtime refuses to load makes no controller")
{
    Place place;
    ToldRuntime runtime;
    const auto controller = Controller::create(
        place.file("c.toml", "[[plc.variable]]\nname = \"Height\"\ntype = \"Double\"\n"), runtime,
        place.options);
    REQUIRE_FALSE(controller);
    CHECK(controller.error().where == "Level");
    CHECK(runtime.story.all() == std::vector<std::string>{"begin", "end"});
}

TEST_CASE("a runtime that is no simulation takes no simulated programs and no project")
{
    Place place;
    ToldRuntime runtime;
    const std::string level = "[[plc.variable]]\nname = \"Level\"\ntype = \"Double\"\n";
    const auto simulated = Controller::create(
        place.file("c.toml", level + "[[plc.program]]\nkind = \"increment\"\ntarget = \"Level\"\n"),
        runtime, place.options);
    REQUIRE_FALSE(simulated);
    CHECK(simulated.error().where == "plc.program");

    Configuration mapped = place.file("d.toml", level);
    mapped.project = place.path("project");
    const auto project = Controller::create(mapped, runtime, place.options);
    REQUIRE_FALSE(project);
    CHECK(project.error().where == mapped.project);

    // But one for labels of the runtime's own.
    runtime.all_labels = controller::SimulatedLabels::create({}, {}).value();
    const auto with_labels = Controller::create(mapped, runtime, place.options);
    REQUIRE(with_labels);
    (*with_labels)->stop();
    CHECK((*with_labels)->run());
}

TEST_CASE("a controller without a machine ignores events of the hardware")
{
    Place place;
    HeldLog log;
    place.options.log = &log;
    ToldRuntime runtime;
    auto controller = Controller::create(
        place.file("c.toml", "[[plc.variable]]\nname = \"Level\"\ntype = \"Double\"\n"), runtime,
        place.options);
    REQUIRE(controller);
    std::thread serving{[&] { CHECK((*controller)->run()); }};
    runtime.story.wait_for("scanned");
    runtime.host_->happen(HardwareEvent::MajorFault);
    runtime.host_->happen(HardwareEvent::MediumOut);
    runtime.host_->power_going();
    runtime.host_->switch_mode(controller::MachineMode::Program);
    CHECK_FALSE(runtime.host_->plc_error());
    runtime.host_->reload();
    log.wait_for_message("read again: "); // it comes to this after the others
    (*controller)->stop();
    serving.join();
}

TEST_CASE("a program that was received counts although the file is damaged before it ran")
{
    Place place;
    const Configuration file = place.file("c.toml", place.machine());
    const auto loads_at_start = [&] {
        ToldRuntime runtime;
        auto controller = Controller::create(file, runtime, place.options);
        REQUIRE(controller);
        (*controller)->stop();
        CHECK((*controller)->run());
        return runtime.story.all()[1];
    };
    CHECK(loads_at_start() == "loaded Level");

    storage::FolderStorage folder{place.path("pki")};
    const auto document = [](const std::string& variables) {
        return document_of({.name = "sent.st",
                            .text = "{attribute 'publish' := 'publish only'}\nVAR_GLOBAL\n" +
                                    variables + "\nEND_VAR\n"});
    };
    REQUIRE(keep_received(folder, document("Fresh : INT; Level : LREAL;")));
    std::ofstream{place.path("c.toml"), std::ios::app} << "[[[\n";
    CHECK(loads_at_start() == "loaded Fresh");
    // One that is damaged, too, is none: the last one that ran is.
    REQUIRE(keep_received(folder, document("Late : INT; Level : LREAL;") + "more"));
    CHECK(loads_at_start() == "loaded Fresh");
    // It was taken back.
    REQUIRE(keep_received(folder, std::nullopt));
    CHECK(loads_at_start() == "loaded Level");
}

TEST_CASE("a list of users or roles that is damaged keeps no machine from running")
{
    Place place;
    const Configuration file = place.file("c.toml", place.machine());
    const auto runs = [&] {
        ToldRuntime runtime;
        auto controller = Controller::create(file, runtime, place.options);
        REQUIRE(controller);
        (*controller)->stop();
        CHECK((*controller)->run());
    };
    std::filesystem::create_directory(place.path("pki"));
    for (const bool is_file_damaged : {false, true}) {
        for (const char* const name : {"pki/users.json", "pki/roles.json"}) {
            std::ofstream{place.path(name)} << "{\"version\":1,";
        }
        if (is_file_damaged) {
            std::ofstream{place.path("c.toml"), std::ios::app} << "[[[\n";
        }
        runs();
        for (const std::string name : {"pki/users.json", "pki/roles.json"}) {
            CHECK(std::filesystem::remove(place.path(name + ".refused")));
        }
        CHECK_FALSE(std::filesystem::exists(place.path("pki/users.json")));
        CHECK(std::filesystem::exists(place.path("pki/roles.json"))); // with all roles closed
    }
}

TEST_CASE("a configuration can be checked without a controller")
{
    Place place;
    CHECK(check(place.file("c.toml", place.machine())));
    const auto wrong = check(place.file("d.toml", "[limits]\nsessions = \"many\"\n"));
    REQUIRE_FALSE(wrong);
    CHECK(wrong.error().where.find("d.toml:12") != std::string::npos);
}

} // namespace runtime_test

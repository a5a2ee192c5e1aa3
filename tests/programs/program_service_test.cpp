#include "product/machine/program_service.hpp"

#include <catch2/catch.hpp>

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <thread>

#include <busbar/administration/audit_log.hpp>
#include <busbar/core/status_codes.hpp>
#include <busbar/server/event.hpp>
#include <busbar/types/ids.hpp>

#include "product/configuration/config.hpp"

namespace program_service_test {

using namespace busbar;
using namespace busbar::product;

// What a tool does with the program of a controller (W588, 3-3-2), without the controller.

namespace {

const std::string declarations = "VAR_GLOBAL\n  Speed : INT;\nEND_VAR\n";

struct FixedClock final : WallClock {
    [[nodiscard]] DateTime now() const override { return DateTime{}; }
};

struct ServiceFixture {
    /// As Administration does it: what takes long is prepared on another thread.
    [[nodiscard]] std::string send(const char* wish, const std::string& file)
    {
        const Variant options{wish};
        const administration::TransferRequest request{options, user, tool, &method};
        const auto bytes = std::as_bytes(std::span{file});
        if (const auto prepare = service.preparation(request, bytes)) {
            std::thread{prepare}.join();
        }
        return std::string{name(service.take(request, bytes))};
    }
    [[nodiscard]] std::string report()
    {
        const Variant options{"report"};
        const auto bytes = service.generate({options, user, tool}, 1'000);
        return bytes ? std::string{reinterpret_cast<const char*>(bytes->data()), bytes->size()}
                     : std::string{name(bytes.error())};
    }
    [[nodiscard]] bool takes_long(const char* wish)
    {
        const Variant options{wish};
        return static_cast<bool>(service.preparation({options, user, tool}, {}));
    }
    [[nodiscard]] static std::shared_ptr<const controller::CheckedProgram> empty_program()
    {
        return controller::CheckedProgram::create({}).value();
    }

    NodeId tool{1, "tool"};
    NodeId method{0, id::TemporaryFileTransferType_CloseAndCommit};
    server::UserIdentity user;
    NullLog lines;
    administration::AuditLog log{lines};
    FixedClock clock;
    std::optional<ProgramChange> asked;
    ProgramService service{
        {.program =
             [] {
                 return ProgramInForce{.name = "a.st",
                                       .text = std::make_shared<const std::string>(),
                                       .program = empty_program(),
                                       .file = "a.st"};
             },
         .base =
             [] {
                 return ProgramBase{{empty_program()}, PlcTrial{ControllerConfig{}}};
             },
         .change =
             [this](const ProgramChange& change) {
                 asked = change;
                 return Configured<ProgramVerdict>{};
             },
         .mode = [] { return controller::MachineMode::Program; },
         .set_mode = [](controller::MachineMode) { return Configured<void>{}; },
         .clock = clock,
         .log = log}};
};

} // namespace

TEST_CASE("Program service: a program that is sent is read before the server's turn", )
{
    ServiceFixture controller;
    for (const char* wish :
         {"check a.st", "compare a.st", "edit a.st", "download a.st", "restore"}) {
        INFO(wish);
        CHECK(controller.takes_long(wish));
    }
    for (const char* wish : {"mode RUN", "check", "nothing"}) {
        INFO(wish);
        CHECK_FALSE(controller.takes_long(wish));
    }
    for (const char* wish : {"check b.st", "edit b.st", "download b.st"}) {
        INFO(wish);
        CHECK(controller.send(wish, declarations) == "Good");
        REQUIRE(controller.asked);
        REQUIRE(controller.asked->prepared);
        CHECK(controller.asked->prepared->files.program->program().variables.size() == 1);
        CHECK(controller.asked->prepared->files.tried != nullptr);
        CHECK(controller.asked->prepared->may_edit);
        controller.asked.reset();
    }
    CHECK(controller.send("compare b.st", declarations) == "Good");
    CHECK(controller.report().find("variable Speed") != std::string::npos);
}

TEST_CASE("Program service: a program that cannot be read changes nothing", )
{
    ServiceFixture controller;
    CHECK(controller.send("download b.st", "VAR_GLOBAL\n  Speed INT;\n") != "Good");
    CHECK_FALSE(controller.asked);
    CHECK(controller.report().find("b.st:2:") != std::string::npos);
    CHECK(controller.send("download b.st", declarations) == "Good");
    CHECK(controller.asked);
}

TEST_CASE("Program service: a Method has one audit event (Part 4, 6.5.9)", )
{
    ServiceFixture controller;
    const auto events = std::make_shared<server::EventQueue>(controller.clock, nullptr, 16);
    controller.log.attach(events, "urn:busbar:test:press");
    for (const char* wish : {"download b.st", "edit b.st"}) {
        CHECK(controller.send(wish, declarations) == "Good");
    }
    CHECK(controller.send("mode RUN", "") == "Good");
    server::Event event;
    CHECK_FALSE(events->next(event));
}

} // namespace program_service_test

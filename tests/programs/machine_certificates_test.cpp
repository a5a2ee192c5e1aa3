#include <catch2/catch.hpp>

#include <algorithm>
#include <chrono>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include <busbar/controller/machine_event_log.hpp>
#include <busbar/crypto/private_key.hpp>
#include <busbar/crypto/self_signed.hpp>
#include <busbar/net/system.hpp>
#include <busbar/storage/folder_storage.hpp>

#include "programs/controllers.hpp"

namespace machine_certificates_test {

// What the logs of a machine say of certificates at its first start (W588, 3-2-4 and 5-1-1).

using namespace busbar;
using namespace busbar::test;

namespace {

const std::string machine_configuration = R"(
[limits]
preset = "nj501"
[machine]
program = "press.st"
execution_log = true
[[endpoint]]
policy = "Basic256Sha256"
mode = "SignAndEncrypt"
[users]
anonymous = "read"
)";

bool comes_true(const std::function<bool()>& is_so)
{
    const auto end = std::chrono::steady_clock::now() + Program::patience;
    while (!is_so()) {
        if (std::chrono::steady_clock::now() > end) {
            return false;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds{50});
    }
    return true;
}

/// As a file, of a client whose certificate was valid until yesterday.
std::string old_certificate()
{
    crypto::CertificateSubject subject;
    subject.common_name = "Old panel";
    subject.application_uri = "urn:busbar:test:panel";
    subject.valid_from = in_days_from_now(-10);
    subject.valid_days = 9;
    const auto key = crypto::PrivateKey::generate(2'048).value();
    const crypto::Certificate made = crypto::create_self_signed(key, subject).value();
    const auto der = made.der();
    return {reinterpret_cast<const char*>(der.data()), der.size()};
}

/// The codes of the events that are kept, with their levels.
std::vector<std::string> kept_events(const std::string& folder)
{
    storage::FolderStorage files{folder};
    const net::SystemWallClock clock;
    NullLog next;
    const auto log = controller::MachineEventLog::create(files, clock, next).value();
    std::vector<std::string> texts;
    if (log->load()) {
        for (const controller::MachineEvent& each : log->events()) {
            texts.push_back(controller::text(each) + " " + std::string{name(each.level)});
        }
    }
    return texts;
}

} // namespace

TEST_CASE("a machine's logs have its new certificate, and a client's that has expired")
{
    const ScratchFolder scratch;
    scratch.write("press/press.st", "VAR_GLOBAL Speed : INT; END_VAR\n");
    scratch.write("press/busbar-certificates/trusted/certs/old.der", old_certificate());
    const Controller press{scratch, "press", machine_configuration};

    CHECK(comes_true([&] {
        const std::string text = scratch.read(
            "press/busbar-medium/packages/OPCUA_Server/ExecutionLog/OPCUA_ExecutionLog.log");
        return text.find("CERT\t0001\tUpdate_Server\tNxOpcUaServer@127.0.0.1") != std::string::npos;
    }));
    CHECK(comes_true([&] {
        return scratch.read("press/log").find("a certificate in trusted expired at") !=
               std::string::npos;
    }));
    const std::string state = scratch.path() + "/press/busbar-machine";
    CHECK(comes_true([&] {
        const auto events = kept_events(state);
        const auto has = [&](const std::string& begin, const std::string& end) {
            return std::any_of(events.begin(), events.end(), [&](const std::string& each) {
                return each.starts_with(begin) && each.ends_with(end);
            });
        };
        return has("95D20000 Server Certificate Generated", " Information") &&
               has("00000000 Client Certificate Expired: Old panel, ", " Observation");
    }));
}

} // namespace machine_certificates_test

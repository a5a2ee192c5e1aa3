#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <busbar/controller/backup.hpp>
#include <busbar/controller/execution_log.hpp>
#include <busbar/controller/life_cycle.hpp>
#include <busbar/controller/machine_event_log.hpp>
#include <busbar/controller/machine_nodes.hpp>
#include <busbar/controller/machine_settings.hpp>
#include <busbar/controller/opcua_shutdown.hpp>
#include <busbar/controller/published_program.hpp>
#include <busbar/controller/retained_values.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/crypto/certificate_notices.hpp>
#include <busbar/crypto/own_certificate.hpp>
#include <busbar/crypto/trusted_certificate_watch.hpp>
#include <busbar/storage/memory_storage.hpp>

namespace busbar::test {

/// Something to be done so much later, on the machine's thread.
using DoLater = std::function<void(Duration, std::function<void()>)>;

/// A controller of W588 with all that it keeps, between two times that it is switched on: what
/// it has to remember lies in the two media. What only hardware and people do are calls.
class VirtualMachine final : private controller::ServerOperator {
public:
    /// All must outlive it. `memory` is the controller's own, with its certificate if it has one.
    VirtualMachine(storage::MemoryStorage& memory, storage::MemoryStorage& card,
                   const WallClock& clock, DoLater later);

    // What people and hardware do.

    void power_on() { life.power_on(); }
    /// A project with this program and these settings.
    void download(controller::Program program, const controller::ServerSettings& settings);
    void edit_online(controller::GlobalVariable added);
    void change_address(const std::string& address);
    /// The new certificate is for the present address.
    void renew_certificate(std::uint32_t days);
    /// Somebody presses the switch of the card before it is taken out.
    void release_card() { static_cast<void>(execution_log->release_medium()); }
    void card_is_in(bool is_in) { life.medium_changed(is_in); }
    [[nodiscard]] Configured<void> restore(std::span<const std::byte> backup);

    /// What is done some times in a second: logs are saved, instructions are served.
    void work();
    /// Retained values of a scan in which the counter has this value.
    [[nodiscard]] Stored<void> scan(std::int16_t counter);
    [[nodiscard]] std::int16_t counter() const;

    /// The program that is in the controller. It begins with the counter, which is an INT.
    controller::Program program;
    NullLog lines;
    std::unique_ptr<controller::MachineEventLog> event_log;
    std::unique_ptr<controller::ExecutionLog> execution_log; // before it
    controller::LifeCycle life;
    controller::MachineSettings settings;
    controller::MachineMemory data;
    controller::InstructionDesk desk;
    std::string address{"192.168.250.1"};
    bool is_open{false};                  // clients may come in
    controller::RetainedRestore restored; // at the last preparation

private:
    void initialize() override;
    void prepare(std::uint32_t number, const controller::ServerSettings& settings) override;
    void reconfigure(std::uint32_t number, const controller::ServerSettings& settings,
                     const controller::StopNotice& notice) override;
    void run() override { is_open = true; }
    void suspend(const controller::StopNotice&) override { is_open = false; }
    void stop(const controller::StopNotice& notice) override;
    void add_variables() override;
    void medium_changed(bool is_in) override;
    void save_now() override;

    void finish_preparation(std::uint32_t number, std::uint32_t port);
    void make_address_space();
    void look_at_certificates();

    storage::MemoryStorage* memory_;
    const WallClock* clock_;
    DoLater later_;
    std::uint32_t preparation_{0};
    std::unique_ptr<controller::PublishedProgram> published_;
    std::optional<controller::Publication> publication_; // with what is added online
    std::vector<std::unique_ptr<controller::ProgramTypes>> edits_;
    std::vector<std::unique_ptr<controller::Program>> edited_;
    model::AddressSpace space_;
    std::optional<controller::MachineNodes> nodes_;
    std::optional<controller::ProgramImage> image_;
    std::unique_ptr<controller::RetainedValues> retained_;
    std::optional<crypto::OwnCertificate> own_;
    crypto::OwnCertificateStore own_store_;
    crypto::CertificateWatch watch_;
    crypto::TrustedCertificateWatch clients_watch_;
    DateTime next_look_{};
    std::int64_t scans_{0};
};

/// The data of such a machine.
[[nodiscard]] std::vector<controller::MemoryItem> virtual_machine_items();

} // namespace busbar::test

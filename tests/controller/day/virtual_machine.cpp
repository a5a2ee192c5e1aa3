#include "virtual_machine.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <utility>

#include <busbar/core/record.hpp>

#include "controller/backup/memory_fixture.hpp"

namespace busbar::test {

using namespace controller;

namespace {

constexpr const char* trusted_folder = "trusted/certs";
constexpr const char* machine_uri = "urn:busbar:machine";

ExecutionLogOptions small_log()
{
    ExecutionLogOptions options;
    options.max_files = 3;
    options.max_records = 100;
    return options;
}

std::vector<crypto::Certificate> certificates_in(Storage& storage, const char* folder)
{
    std::vector<crypto::Certificate> certificates;
    const auto listing = storage.list(folder, 100);
    for (const StorageEntry& entry : listing ? listing->entries : std::vector<StorageEntry>{}) {
        const auto bytes = read_file(storage, storage_path(folder, entry.name), 65'536);
        const auto read = bytes ? crypto::Certificate::parse(*bytes) : fail(status::Bad_NotFound);
        if (read) {
            certificates.push_back(*read);
        }
    }
    return certificates;
}

} // namespace

std::vector<MemoryItem> virtual_machine_items()
{
    std::vector<MemoryItem> items = machine_items();
    items.back().files.clear();
    items.back().folders = {MachineEventLogOptions{}.folder};
    return items;
}

VirtualMachine::VirtualMachine(storage::MemoryStorage& memory, storage::MemoryStorage& card,
                               const WallClock& clock, DoLater later)
    : event_log{MachineEventLog::create(memory, clock, lines).value()},
      execution_log{ExecutionLog::create(card, clock, *event_log, small_log()).value()},
      life{*this, clock, *execution_log}, settings{memory, "server.json", "security.json",
                                                   "transaction"},
      data{memory, "transaction", virtual_machine_items(), *execution_log}, memory_{&memory},
      clock_{&clock}, later_{std::move(later)}, own_store_{memory}, watch_{*execution_log},
      clients_watch_{*execution_log, "trusted"}
{
}

void VirtualMachine::download(Program new_program, const ServerSettings& new_settings)
{
    life.download_begins();
    const auto transferred = settings.transfer(new_settings, life.mode());
    if (transferred) {
        program = std::move(new_program);
    }
    life.download_done(transferred ? Configured<ServerSettings>{settings.server()}
                                   : Unexpected{transferred.error()});
}

void VirtualMachine::edit_online(GlobalVariable added)
{
    program.variables.push_back(added);
    edited_.push_back(std::make_unique<Program>());
    edited_.back()->variables.push_back(std::move(added));
    life.online_edit();
}

void VirtualMachine::change_address(const std::string& new_address)
{
    address = new_address;
    life.address_changed();
    look_at_certificates();
}

void VirtualMachine::renew_certificate(std::uint32_t days)
{
    crypto::OwnCertificateSettings wish{crypto::subject_of(own_->certificates.front())};
    wish.subject.ip_addresses = {address};
    wish.subject.common_name = "NxOpcUaServer@" + address;
    wish.subject.valid_days = days;
    own_ = own_store_.regenerate(wish, clock_->now()).value();
    Record record{RecordKind::CertificateUpdated};
    record.certificate = own_->certificates.front().der();
    tell(*execution_log, record);
    life.certificate_renewed();
    look_at_certificates();
}

Configured<void> VirtualMachine::restore(std::span<const std::byte> backup)
{
    life.restore_begins();
    const auto restored = data.restore(backup, {});
    life.restore_done(restored.has_value());
    return restored.transform([](Restored) {});
}

void VirtualMachine::work()
{
    desk.serve(life, *execution_log);
    if (own_ && clock_->now() >= next_look_) {
        look_at_certificates();
    }
    // What fails is told by the logs themselves.
    static_cast<void>(execution_log->write_pending());
    static_cast<void>(event_log->write_pending());
}

Stored<void> VirtualMachine::scan(std::int16_t counter)
{
    server::ProcessImage& image = *image_->image();
    image.begin_scan();
    image.memory().value<std::int16_t>(0) = counter;
    image.publish(DateTime{++scans_});
    return retained_->save();
}

std::int16_t VirtualMachine::counter() const
{
    return image_->image()->memory().value<std::int16_t>(0);
}

// Of the operator.

void VirtualMachine::initialize()
{
    const auto recovered = data.recover();
    const auto loaded = recovered ? settings.load() : recovered;
    static_cast<void>(event_log->load());
    auto own = own_store_.load();
    own_ = own ? *std::move(own) : std::nullopt;
    if (loaded) {
        life.initialized(settings.server());
    } else {
        life.initialized(Unexpected{loaded.error()});
    }
    look_at_certificates();
}

void VirtualMachine::prepare(std::uint32_t number, const ServerSettings& its_settings)
{
    preparation_ = number;
    later_(std::chrono::seconds{2}, [this, number, port = its_settings.port] {
        if (number == preparation_) {
            finish_preparation(number, port);
        }
    });
}

void VirtualMachine::reconfigure(std::uint32_t number, const ServerSettings& its_settings,
                                 const StopNotice&)
{
    is_open = false;
    prepare(number, its_settings);
}

void VirtualMachine::finish_preparation(std::uint32_t number, std::uint32_t port)
{
    make_address_space();
    tell(*execution_log, *publication_);
    life.prepared(number, "opc.tcp://" + address + ":" + std::to_string(port));
}

void VirtualMachine::make_address_space()
{
    published_ = PublishedProgram::create(program, nj501_publishing()).value();
    publication_.emplace(published_->types(), nj501_publishing());
    space_ = {};
    MachineNodesOptions options;
    options.namespace_uri = machine_uri;
    options.types = nj501_types();
    nodes_ = MachineNodes::create(space_, published_->program(), *publication_, options).value();
    image_ = published_->make_image(nodes_->namespace_index(), {}).value();
    retained_ = std::make_unique<RetainedValues>(*memory_, published_->types(), *image_);
    restored = retained_->restore();
    edited_.clear();
    edits_.clear();
}

void VirtualMachine::add_variables()
{
    edits_.push_back(std::make_unique<ProgramTypes>(ProgramTypes::create(*edited_.back()).value()));
    const PublicationGroup group = publication_->add(*edits_.back());
    REQUIRE(nodes_->add_variables(space_, *publication_));
    tell(*execution_log, *publication_, group);
}

void VirtualMachine::stop(const StopNotice&)
{
    is_open = false;
    preparation_ = 0;
    life.stopped();
    save_now();
}

void VirtualMachine::medium_changed(bool is_in)
{
    execution_log->medium_changed(is_in ? LogMedium::In : LogMedium::Out);
}

void VirtualMachine::save_now()
{
    static_cast<void>(execution_log->flush());
    static_cast<void>(event_log->write_pending());
}

void VirtualMachine::look_at_certificates()
{
    if (!own_) {
        return;
    }
    const DateTime now = clock_->now();
    const std::array hosts{address};
    next_look_ = std::min(watch_.check(own_->certificates.front(), now, hosts),
                          clients_watch_.check(certificates_in(*memory_, trusted_folder), now));
}

} // namespace busbar::test

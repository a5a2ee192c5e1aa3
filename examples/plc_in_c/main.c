/* A PLC's scan loop that publishes its variables once per scan and serves them in the time that is
 * left, on one thread, in C99.
 * usage: EXAMPLE_PASSWORD=... plc-in-c [PORT] */
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <busbar/busbar.h>

/* The variables of the program, as any C program has them. */
struct drive {
    double force;
    uint32_t count;
    bool is_on;
};

static struct {
    uint32_t scans;
    double set_point;
    double positions[4];
    struct drive drive;
    BUSBAR_TEXT_MEMBER(recipe, 32);
} plc;

enum { CYCLE_MS = 10, TICKS_PER_MS = 10000 };

static volatile sig_atomic_t is_to_stop;

static void on_signal(int number)
{
    (void)number;
    is_to_stop = 1;
}

static busbar_status stop_drive(void* context, busbar_call* call, const busbar_value* inputs,
                                size_t input_count, busbar_value* outputs, size_t output_count)
{
    (void)context, (void)call, (void)inputs, (void)input_count, (void)output_count;
    outputs[0].as.uint32 = plc.drive.count;
    plc.drive.is_on = false;
    return BUSBAR_GOOD;
}

/* Describes the variables to the server: their types and where they lie. */
static busbar_status publish_variables(busbar_server* server, busbar_image** image)
{
    uint16_t press = 0;
    busbar_status status = busbar_server_add_namespace(server, "urn:example:press", &press);
    if (status != BUSBAR_GOOD) {
        return status;
    }
    const busbar_field members[] = {{"Force", BUSBAR_DOUBLE, 0, 0, NULL},
                                    {"Count", BUSBAR_UINT32, 0, 0, NULL},
                                    {"IsOn", BUSBAR_BOOLEAN, 0, 0, NULL}};
    busbar_node node;
    memset(&node, 0, sizeof node);
    node.namespace_index = press;
    node.name = "DriveType";
    busbar_structure* drive = NULL;
    status = busbar_server_add_structure(server, &node, members, 3, &drive);
    if (status != BUSBAR_GOOD || busbar_structure_size(drive) != sizeof(struct drive)) {
        return status != BUSBAR_GOOD ? status : BUSBAR_BAD_INTERNAL_ERROR;
    }
#define AT(member) (size_t)((char*)&plc.member - (char*)&plc)
    const busbar_image_variable variables[] = {
        {{"Scans", BUSBAR_UINT32, 0, 0, NULL}, AT(scans), false},
        {{"SetPoint", BUSBAR_DOUBLE, 0, 0, NULL}, AT(set_point), true},
        {{"Positions", BUSBAR_DOUBLE, 4, 0, NULL}, AT(positions), false},
        {{"Drive", BUSBAR_EXTENSION_OBJECT, 0, 0, drive}, AT(drive), true},
        {{"Recipe", BUSBAR_STRING, 0, 32, NULL}, AT(recipe), true}};
    busbar_image_config config;
    memset(&config, 0, sizeof config);
    config.size = sizeof config;
    config.memory = &plc;
    config.memory_size = sizeof plc;
    config.variables = variables;
    config.count = sizeof variables / sizeof variables[0];
    config.namespace_index = press;
    config.cycle_us = CYCLE_MS * 1000;
    status = busbar_server_add_image(server, &config, image);
    if (status != BUSBAR_GOOD) {
        return status;
    }
    node.name = "StopDrive";
    const busbar_argument count = {"Count", BUSBAR_UINT32, false, "Strokes so far"};
    return busbar_server_add_method(server, &node, NULL, 0, &count, 1, stop_drive, NULL);
}

/* One scan: from inputs to outputs. */
static void scan(void)
{
    for (int i = 0; i < 4; ++i) {
        plc.positions[i] = plc.set_point * sin(0.01 * plc.scans + i);
    }
    plc.drive.force = plc.drive.is_on ? plc.set_point / 10 : 0;
    plc.drive.count += plc.drive.is_on ? 1 : 0;
    ++plc.scans;
}

static void run(busbar_server* server, busbar_image* image)
{
    busbar_time next = busbar_now();
    busbar_time now = next;
    do {
        busbar_image_begin_scan(image); /* what clients have written is in memory now */
        scan();
        busbar_image_publish(image, now); /* what clients see from now on */
        if (is_to_stop) {
            busbar_server_stop(server);
        }
        next += CYCLE_MS * TICKS_PER_MS;
        now = busbar_now();
        if (now - next > 1000 * TICKS_PER_MS || next - now > CYCLE_MS * TICKS_PER_MS) {
            next = now; /* the clock was set */
        }
    } while (busbar_server_poll(server, next > now ? (uint32_t)((next - now) / TICKS_PER_MS) : 0) ==
             BUSBAR_GOOD);
    busbar_image_halt(image);
}

int main(int argc, char** argv)
{
    char hash[160];
    const busbar_user user = {"operator", hash, false};
    if (busbar_hash_password(getenv("EXAMPLE_PASSWORD"), 0, hash, sizeof hash) != BUSBAR_GOOD) {
        fputs("usage: EXAMPLE_PASSWORD=... plc-in-c [PORT]\n", stderr);
        return 2;
    }
    plc.set_point = 100;
    plc.drive.is_on = true;
    memcpy(plc.recipe.data, "cover plate", plc.recipe.size = 11);

    busbar_server_config config;
    busbar_server_config_init(&config);
    config.application.uri = "urn:example:plc-in-c";
    config.application.name = "PLC in C";
    config.application.folder = "plc_in_c_pki";
    config.limits = BUSBAR_LIMITS_SMALL;
    config.port = (uint16_t)atoi(argc > 1 ? argv[1] : "4840");
    config.users = &user;
    config.user_count = 1;
    busbar_server* server = NULL;
    busbar_image* image = NULL;
    busbar_status status = busbar_server_create(&config, &server);
    if (status == BUSBAR_GOOD) {
        status = publish_variables(server, &image);
    }
    if (status == BUSBAR_GOOD) {
        status = busbar_server_start(server);
    }
    if (status == BUSBAR_GOOD) {
        signal(SIGTERM, on_signal);
        fprintf(stderr, "ready at port %d\n", busbar_server_port(server));
        run(server, image);
    } else {
        fprintf(stderr, "%s: %s\n", busbar_status_name(status), busbar_server_last_error(server));
    }
    busbar_server_destroy(server);
    return status != BUSBAR_GOOD;
}

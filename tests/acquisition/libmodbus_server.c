/* A plain analogue module served by libmodbus, which takes 32-bit patterns apart by itself.
 *
 * Holding register 0 is the output; holding register 1 and input register 0 measure it, times
 * three. Registers 100 to 107 hold one pattern in four orders; patterns written in these orders to
 * 110 to 117 appear with the most significant byte first at 120 to 127. Prints its port.
 */
#include <modbus/modbus.h>
#include <netinet/in.h>
#include <stdio.h>
#include <unistd.h>

#define PATTERN 0x01020304u
#define SWAP_WORDS 1
#define SWAP_BYTES 2

static uint16_t swap_if(int wanted, uint16_t word) {
    return wanted ? (uint16_t)(word << 8 | word >> 8) : word;
}

/* Exchange plain order, abcd, and one of abcd, cdab, badc and dcba (order 0 to 3). */
static void convert(int order, const uint16_t *source, uint16_t *target) {
    int first = order & SWAP_WORDS ? 1 : 0;
    target[0] = swap_if(order & SWAP_BYTES, source[first]);
    target[1] = swap_if(order & SWAP_BYTES, source[1 - first]);
}

static void measure(modbus_mapping_t *map) {
    map->tab_registers[1] = map->tab_input_registers[0] = (uint16_t)(3 * map->tab_registers[0]);
    for (int order = 0; order < 4; order++)
        convert(order, map->tab_registers + 110 + 2 * order, map->tab_registers + 120 + 2 * order);
}

static void answer(modbus_t *link, modbus_mapping_t *map) {
    uint8_t request[MODBUS_TCP_MAX_ADU_LENGTH];
    int length;
    while ((length = modbus_receive(link, request)) >= 0)
        if (length > 0) {
            modbus_reply(link, request, length, map);
            measure(map);
        }
    modbus_close(link);
}

int main(void) {
    const uint16_t pattern[] = {PATTERN >> 16, PATTERN & 0xFFFF};
    modbus_t *link = modbus_new_tcp("127.0.0.1", 0);
    modbus_mapping_t *map = modbus_mapping_new(0, 0, 200, 10);
    int listener = modbus_tcp_listen(link, 1);
    struct sockaddr_in address;
    socklen_t size = sizeof address;

    if (!map || listener < 0 || getsockname(listener, (struct sockaddr *)&address, &size))
        return 1;
    for (int order = 0; order < 4; order++)
        convert(order, pattern, map->tab_registers + 100 + 2 * order);
    printf("%d\n", ntohs(address.sin_port));
    fflush(stdout);
    while (modbus_tcp_accept(link, &listener) >= 0)
        answer(link, map);
    return 1;
}

/* The kernel's uncompressed image, where its head expects to be started. */
    .section .kernel, "a", %progbits
    .incbin KERNEL_IMAGE
